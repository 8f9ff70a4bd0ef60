"""Whether a profile meets its requirement, and what would where it does not (S1-F45).

In: a profile and a time with its tolerance.  Out: yes or no, why, and the remedy: another acceleration while the motor
can still start and stop at it, else a motor with a higher pull-out speed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import LimitError

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.pulses.ramps.demand import Demand
    from trochia.pulses.ramps.profile import Profile


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """A time to be kept within a tolerance (a fraction of it) either way [s]."""

    time: float
    tolerance: float = 0.05

    @property
    def band(self) -> tuple[float, float]:
        """The shortest and the longest time that do [s]."""
        return self.time * (1.0 - self.tolerance), self.time * (1.0 + self.tolerance)


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """The answer; ``remedy`` is None where none is needed."""

    ok: bool
    reason: str
    remedy: str | None = None


def judge(profile: Profile, requirement: Requirement | None, better: Callable[[float], Profile]) -> Verdict:
    """Return the verdict; ``better`` gives a profile of equal ramps for a given time, or raises."""
    demand, took = profile.demand, profile.duration
    peak = f"peak {demand.said(profile.peak)}"
    if requirement is None:
        return Verdict(ok=True, reason=f"all in {took:.4g} s, {peak}")
    low, high = requirement.band
    band = f"{requirement.time:g} s ±{100 * requirement.tolerance:g} % ({low:.4g} to {high:.4g} s)"
    if low <= took <= high:
        return Verdict(ok=True, reason=f"{took:.4g} s lies within {band}, {peak}")
    late = took > high
    reason = f"{took:.4g} s is {'longer' if late else 'shorter'} than {band}, {peak}"
    return Verdict(ok=False, reason=reason, remedy=_remedy(demand, requirement.time, better))


def _remedy(demand: Demand, time: float, better: Callable[[float], Profile]) -> str:
    """Return what to change."""
    try:
        cure = better(time)
    except LimitError as error:
        return f"No acceleration does it: {error.message}; take a motor with a higher pull-out or start/stop speed."
    return (
        f"With {demand.said_acceleration(cure.demand.rising)} up and down it takes {cure.duration:.4g} s; its "
        f"first step is made at {demand.said(float(cure.speeds[0]))}."
    )
