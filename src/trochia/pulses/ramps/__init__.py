"""Step-domain ramps: a move from rest to rest to the delay before each of its steps.

One file a law; a row in ``RAMPS`` makes it known to the command line and tested.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.pulses.ramps import austin, exact, library, linear, torque
from trochia.pulses.ramps.checks import check_start_stop, check_torque
from trochia.pulses.ramps.curve import TorqueCurve, read_curve
from trochia.pulses.ramps.demand import Demand, shown_up
from trochia.pulses.ramps.profile import COLUMNS, Profile
from trochia.pulses.ramps.time_box import into_box
from trochia.pulses.ramps.verdict import Requirement, Verdict, judge

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

_LONGER = 250  # times of 2 % more: a hundredfold


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramp:
    """One law.

    Attributes
    ----------
    name, title
        As the command line and as a plot calls it.
    delays
        A demand to the delay before each step (steps,) [s].
    slack
        How far its whole time may lie from the exact law's, in first delays of that, beside a step of ramp length.
    by_torque
        Whether a torque curve, in place of an acceleration, sets how fast it speeds up.
    total
        Whole time in closed form [s], where there is one.
    """

    name: str
    title: str
    delays: Callable[[Demand], NDArray[np.float64]]
    slack: float = 0.0
    by_torque: bool = False
    total: Callable[[Demand], float] | None = None

    def duration(self, demand: Demand) -> float:
        """Return the whole time of a move [s]."""
        return float(self.delays(demand).sum()) if self.total is None else self.total(demand)


RAMPS: dict[str, Ramp] = {
    row.name: row
    for row in (
        Ramp(name="exact", title="Exact square root", delays=exact.delays, total=exact.total),
        Ramp(name="austin", title="Austin's recursion", delays=austin.delays, slack=1.5),
        Ramp(name="linear", title="Linear in time", delays=linear.delays, total=exact.total),
        Ramp(name="library", title="Step library's rule", delays=library.delays, slack=3.0),
        Ramp(name="torque", title="Limited by torque", delays=torque.delays, by_torque=True),
    )
}


def profile(demand: Demand, law: str = "exact", *, time_box: float | None = None) -> Profile:
    """Return the profile a law gives, checked against start/stop speed and torque.

    Parameters
    ----------
    demand
        The move.
    law
        A name of ``RAMPS``.
    time_box
        Time in which the move must end [s]: the deceleration is chosen for it, or both ramps where no acceleration is
        given.

    Raises
    ------
    LimitError
        For a law that is not there, and for what the motor cannot do, with the number that would do.
    """
    if law not in RAMPS:
        raise LimitError(f"there is no law {law!r}", hint=f"There are {', '.join(RAMPS)}.")
    ramp = RAMPS[law]
    if time_box is None:
        return _checked(demand, ramp)
    if ramp.by_torque:
        raise LimitError(
            f"the law `{law}` goes as fast as it can, which no time box changes",
            hint="Require a time of it, or put the law `exact` into the box.",
        )
    boxed = into_box(demand, ramp.duration, time_box)
    try:
        return _checked(boxed, ramp)
    except LimitError as error:
        time = _least_time(demand, ramp, time_box)
        if time is None:
            raise
        raise LimitError(
            f"to end in {time_box:g} s, {error.message}",
            hint=f"{shown_up(time)} s would do, or a motor that starts and speeds up faster.",
        ) from None


def one_acceleration(made: Profile) -> bool:
    """Return whether one acceleration up and one down made it: not torque, and no times that were measured."""
    return made.law in RAMPS and not RAMPS[made.law].by_torque


def _checked(demand: Demand, ramp: Ramp) -> Profile:
    """Return a profile that start/stop speed and torque allow."""
    made = Profile(law=ramp.name, title=ramp.title, demand=demand, delays=ramp.delays(demand))
    if not ramp.by_torque:
        check_torque(demand, made.peak)
    check_start_stop(made, ramp.delays)
    return made


def _least_time(demand: Demand, ramp: Ramp, time: float) -> float | None:
    """Return a time above ``time`` [s], the shortest within 2 %, into which the move goes; None where none is found."""
    for _ in range(_LONGER):
        time *= 1.02
        try:
            _checked(into_box(demand, ramp.duration, time), ramp)
        except LimitError:
            continue
        return time
    return None


def verdict(made: Profile, requirement: Requirement | None = None) -> Verdict:
    """Return whether a profile meets a requirement, and the remedy where it does not."""
    law = made.law if one_acceleration(made) else "exact"

    def better(time: float) -> Profile:
        return profile(replace(made.demand, acceleration=None, deceleration=None), law, time_box=time)

    def faster(acceleration: float) -> Profile:
        return profile(replace(made.demand, acceleration=acceleration, deceleration=acceleration), law)

    return judge(made, requirement, better, faster)


__all__ = ["COLUMNS", "RAMPS", "Demand", "Profile", "Ramp", "Requirement", "TorqueCurve", "Verdict", "one_acceleration",
           "profile", "read_curve", "verdict"]  # fmt: skip
