"""A servo joint of the live twin: its loop follows commands as they come, a servo period at a time.

In: positions commanded, a servo period apart.  Out: where load and motor are at each, and the greatest lag on the way.

Only the past of the command is known here, so velocity and acceleration wanted are differences to the last two, of
second order.  A loop of another period than the machine's sees them in between.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.twin import TwinJoint
from trochia.servo.joint import JointServo, at_rest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.joints import Joint
    from trochia.machine.servos.drive import ServoDrive

SETTLING = 0.5  #: a loop goes on for so long after its command has come to rest [s]


class LiveServo:
    """One servo at rest at ``position`` [mm or degree].

    Attributes
    ----------
    measured
        What its encoder says.
    readings
        What it said at each command of the last call (ticks,).
    lag
        Greatest error over the last call.
    """

    def __init__(self, joint: Joint, drive: ServoDrive, *, position: float, tick: float) -> None:
        self._joint, self._drive, self._tick = joint, drive, tick
        self._play = TwinJoint(position, name=joint.name, backlash=drive.play)
        self.rejoin(position)

    def rejoin(self, position: float) -> None:
        """Close the loop anew with motor and command at a position, at rest."""
        self._servo = JointServo(self._drive, position=position, name=self._joint.name)
        self._servo.run(at_rest(position, math.ceil(SETTLING / self._drive.period)))
        self._past = np.full(2, position)
        self._now = 0  # servo periods since
        self._done = 1  # ticks of the loop since: the one at 0 stands for the past
        self._last = np.array([[0.0], [position]])  # time, and where the motor was at the last tick
        self.measured, self.lag, self._rest = position, 0.0, math.inf
        self.readings = np.full(1, position)

    @property
    def restless(self) -> bool:
        """Whether it may still be moving."""
        return self._rest < SETTLING

    def follow(self, commanded: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Follow commands (ticks,) [mm or degree]; return motor and load at each (ticks,)."""
        known = np.concatenate([self._past, commanded])
        now, before, earlier = known[2:], known[1:-1], known[:-2]
        tick, period = self._tick, self._drive.period
        sets = np.stack([now, (3 * now - 4 * before + earlier) / (2 * tick), (now - 2 * before + earlier) / tick**2])
        sets = np.concatenate([np.array([[before[0]], [0.0], [0.0]]), sets], axis=1)
        at = tick * np.arange(self._now, self._now + len(commanded) + 1, dtype=np.float64)
        loop = period * np.arange(self._done, math.floor(at[-1] / period + 1e-6) + 1, dtype=np.float64)
        self.lag = 0.0
        self.readings = np.full(len(commanded), self.measured)
        if loop.size:
            sets[1:, 0] = sets[1:, 1]  # within the first period, as at its end
            wanted = np.stack([np.interp(loop, at, row) for row in sets], axis=1)
            rows = self._servo.run(wanted)
            latest = loop.searchsorted(at[1:] * (1.0 + 1e-9), side="right") - 1
            self.readings = np.where(latest >= 0, rows.measured[np.maximum(latest, 0)], self.measured)
            self.measured = float(rows.measured[-1])
            self.lag = float(np.abs(wanted[:, 0] - rows.measured).max())
            self._last = np.concatenate([self._last, np.stack([loop, rows.load])], axis=1)
            self._done += loop.size
        travel = np.interp(at[1:], *self._last)
        self._last = self._last[:, -1:]
        self._past, self._now = known[-2:], self._now + len(commanded)
        moved = np.flatnonzero(now != before)
        self._rest = tick * (len(now) - 1 - moved[-1]) if moved.size else self._rest + tick * len(now)
        return travel, self._play.run(travel).load
