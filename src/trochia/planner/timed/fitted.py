"""A shaped motion as cubics in time.  In: any trajectory.  Out: one whose phases are there, for those who make steps.

Cubics meet position and velocity at even instants h apart.  Between them they are off by h⁴ / 384 of the snap, and by
h² / 32 of a jump of acceleration at most: 0.03 µm where h is 1 ms and 1000 mm/s² begin at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.planner.timed.motion import plan_timed
from trochia.planner.timed.pieces import hermite

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.planner.trajectory import Trajectory

_MOST = 500_000  #: cubics: some 200 bytes each for three axes


def fitted(trajectory: Trajectory, machine: Machine) -> Trajectory:
    """Return the trajectory itself where it is not shaped, else one of a cubic a servo period, 500,000 at most."""
    if trajectory.shaping is None:
        return trajectory
    count = int(np.clip(np.ceil(trajectory.duration / machine.servo_period), 1, _MOST))
    times = np.linspace(0.0, trajectory.duration, count + 1)
    path = trajectory.path
    moves = path.segments["move"][trajectory.states((times[1:] + times[:-1]) / 2)["segment"]].astype(np.int64)
    pieces = hermite(trajectory.position(times), trajectory.velocity(times), np.diff(times), moves)
    return plan_timed(pieces, trajectory.program, machine)
