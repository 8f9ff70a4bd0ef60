"""Whether a profile meets its requirement, and what would where it does not (S1-F45).

In: a profile and a time with its tolerance.  Out: yes or no, why, and the remedy: another acceleration while the motor
can still start and stop at it, else a motor with a higher pull-out speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import LimitError
from trochia.pulses.ramps.demand import shown_up

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.pulses.ramps.demand import Demand
    from trochia.pulses.ramps.profile import Profile

    _Remedy = tuple[str, Profile | None]

_NONE = 1e12  # steps/s²: an acceleration that is none any more
_NEARLY = 1.0 - 1e-9  # of a speed: reached
_AMPLE = 1.05  #: of the least acceleration that reaches a speed: laws in whole steps need some more


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """A time to be kept within a tolerance (a fraction of it) either way [s], a speed to be reached [steps/s]."""

    time: float | None = None
    tolerance: float = 0.05
    speed: float | None = None

    @property
    def band(self) -> tuple[float, float]:
        """The shortest and the longest time that do [s]."""
        if self.time is None:
            return 0.0, math.inf
        return self.time * (1.0 - self.tolerance), self.time * (1.0 + self.tolerance)


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The answer; ``remedy`` is None where none is needed, ``cure`` the profile it speaks of, where it does."""

    ok: bool
    reason: str
    remedy: str | None = None
    cure: Profile | None = None


def judge(
    profile: Profile, requirement: Requirement | None, better: Callable[[float], Profile],
    faster: Callable[[float], Profile],
) -> Verdict:  # fmt: skip
    """Return the verdict.

    ``better`` gives a profile of equal ramps for a given time, ``faster`` one for a given acceleration up and down
    [steps/s²], or they raise.
    """
    demand, took = profile.demand, profile.duration
    peak = f"peak {demand.said(profile.peak)}"
    if requirement is None:
        return Verdict(ok=True, reason=f"all in {took:.4g} s, {peak}")
    if requirement.speed is not None and profile.peak < requirement.speed * _NEARLY:
        remedy, cure = _remedy_speed(profile, requirement.speed, faster)
        return Verdict(ok=False, reason=f"it gets to {demand.said(profile.peak)} only, of "
                       f"{demand.said(requirement.speed)} to be reached", remedy=remedy, cure=cure)  # fmt: skip
    if requirement.time is None:
        return Verdict(ok=True, reason=f"the speed is reached, all in {took:.4g} s, {peak}")
    low, high = requirement.band
    band = f"{requirement.time:g} s ±{100 * requirement.tolerance:g} % ({low:.4g} to {high:.4g} s)"
    if low <= took <= high:
        return Verdict(ok=True, reason=f"{took:.4g} s lies within {band}, {peak}")
    late = took > high
    reason = f"{took:.4g} s is {'longer' if late else 'shorter'} than {band}, {peak}"
    remedy, cure = _remedy(demand, requirement.time, better)
    return Verdict(ok=False, reason=reason, remedy=remedy, cure=cure)


def _remedy_speed(profile: Profile, speed: float, faster: Callable[[float], Profile]) -> _Remedy:
    """Return what to change for a speed to be reached: the limit, the acceleration, or the length."""
    demand = profile.demand
    if speed > demand.speed:
        return f"The move is limited to {demand.said(demand.speed)}; allow it {demand.said(speed)}.", None
    acceleration = _AMPLE * speed * speed / demand.steps
    try:
        while (cure := faster(acceleration)).peak < speed * _NEARLY and acceleration < _NONE:
            acceleration *= _AMPLE
    except LimitError as error:
        steps = _AMPLE * demand.steps * (demand.speed / profile.peak) ** 2
        return f"More acceleration is not to be had: {error.message}; {math.ceil(steps)} steps would reach it.", None
    return (
        f"With {shown_up(acceleration)} steps/s² ({shown_up(acceleration * demand.step_angle)} rad/s²) up and down it "
        f"is reached; the first step is made at {demand.said(float(cure.speeds[0]))}."
    ), cure


def _remedy(demand: Demand, time: float, better: Callable[[float], Profile]) -> _Remedy:
    """Return what to change."""
    try:
        cure = better(time)
    except LimitError as error:
        hint = "" if error.hint is None else f" {error.hint}"
        return f"No acceleration does it: {error.message}.{hint}", None
    return (
        f"With {demand.said_acceleration(cure.demand.rising)} up and down it takes {cure.duration:.4g} s; its "
        f"first step is made at {demand.said(float(cure.speeds[0]))}."
    ), cure
