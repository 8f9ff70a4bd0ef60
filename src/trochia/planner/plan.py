"""The one call.  In: a program's path, its machine, the name of a profile.  Out: its Trajectory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.planner.corners import paced
from trochia.planner.limits import Limits
from trochia.planner.rests import rests_of
from trochia.planner.s_curve import SCurveSchedule
from trochia.planner.shaping import Shaping
from trochia.planner.torque import TorqueSchedule
from trochia.planner.trajectory import Trajectory
from trochia.planner.trapezoid import TrapezoidSchedule

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.planner.schedule import Profile
    from trochia.program import Program
    from trochia.toolpath import Toolpath

#: every velocity profile by its name
PROFILES: dict[str, Profile] = {
    "trapezoid": TrapezoidSchedule,
    "s-curve": SCurveSchedule,
    "torque": TorqueSchedule,
}


def profile_of(machine: Machine, asked: str | None = None) -> str:
    """Return the name of the profile to plan with: that asked for, else the machine's own, else the smoothest it can.

    That is ``s-curve`` where every axis has a jerk limit, else ``trapezoid``.

    Raises
    ------
    LimitError
        When there is no such profile.
    """
    smoothest = "s-curve" if all(axis.jerk is not None for axis in machine.axes) else "trapezoid"
    name = asked or machine.profile or smoothest
    if name not in PROFILES:
        raise LimitError(f"there is no velocity profile {name!r}", hint="There are: " + ", ".join(sorted(PROFILES)))
    return name


def plan(path: Toolpath, machine: Machine, *, program: Program, profile: str = "trapezoid") -> Trajectory:
    """Return the motion of a program along its path, as fast as the machine's limits allow, and shaped as it asks.

    Parameters
    ----------
    path
        Built with the profile's ``continuity``; with less, a profile stops where what it needs is missing.

    Raises
    ------
    LimitError
        When there is no such profile, or the machine lacks what it needs.
    """
    profile = profile_of(machine, profile)
    limits = Limits.of(machine, motors=PROFILES[profile].by_curves)
    rests = rests_of(program, machine, path)
    schedule = PROFILES[profile](paced(path, limits), limits, rests) if len(path) else None
    still = sum(rests.times.values())
    shaping = None if schedule is None else Shaping.of(machine, limits)
    duration = (still if schedule is None else schedule.duration) + (shaping.delay if shaping else 0.0)
    return Trajectory(
        program=program, path=path, limits=limits, profile=profile, schedule=schedule,
        times={"motion": duration - still} | rests.times, duration=duration, shaping=shaping,
    )  # fmt: skip
