"""From one plan to another while moving.  In: the motion in hand, another plan.  Out: a motion that joins that.

The other plan, made for other speeds, passes the place of now at its own speed.  A ramp leads from the state of now to
the state that the other has somewhere ahead; where is found by the way the ramp takes, and the ramp must keep every
limit.  Until one is found, the motion in hand goes on, at last to its next rest, which both plans share.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.planner.live.hold import before, following, kicks, strengths
from trochia.planner.live.laid import keeps, lay
from trochia.planner.live.portion import states_at
from trochia.planner.live.road import Place
from trochia.planner.ramp import ramp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.planner.live.road import Road
    from trochia.planner.live.window import Rules

_INSTANTS = 24  #: in a worst stopping time at which a way over is looked for
_MET = 1e-10  #: mm
_SEARCH = 48  #: places on the other plan that are tried before the one between two of them is refined


class Crossing(NamedTuple):
    """A ramp (phases) that leads to the other plan, and when that is there, by its own time [s]."""

    phases: NDArray[Any]
    at: float


def change(
    road: Road, rules: Rules, phases: NDArray[Any], other: NDArray[Any], t: float, *, feed: float, until: float
) -> tuple[NDArray[Any], NDArray[Any]] | None:
    """Return the phases in hand up to the other plan, and its phases from there on; None: no way before ``until``.

    Parameters
    ----------
    other
        A plan of the same road which begins before the place of ``t`` (its times are its own) and ends at rest.
    feed
        Override of programmed feeds that may still be kept on the way.
    """
    instant, step = t, rules.stopping_time / _INSTANTS
    jumps = kicks(phases) if rules.jerk_limited else np.zeros(0)
    while instant < until:
        state = states_at(phases, np.array([instant]))[0]
        crossing = None if state["flags"] & 1 else cross(road, rules, state, other, feed)
        if crossing is not None:
            led = np.concatenate([before(phases, instant), crossing.phases])
            end = float(led["t"][-1] + led["duration"][-1])
            return led, after(other, crossing.at, end)
        instant = following(jumps, instant, step)
    return None


def cross(road: Road, rules: Rules, state: NDArray[Any], other: NDArray[Any], feed: float) -> Crossing | None:
    """Return the strongest ramp from a state to another plan that keeps every limit; None where there is none."""
    place = Place(int(state["segment"]), float(state["s"]))
    ahead = Ahead(road, other, place)
    for most in strengths(road, rules, state):
        at = _meet(state, ahead, most, 4.0 * rules.stopping_time)
        if at is None:
            continue
        pieces = ramp(_motion(state), _motion(ahead.state(at)), *most)
        phases = lay(road, place, pieces, float(state["t"]))
        if phases is not None and keeps(road, rules, phases, feed):
            return Crossing(phases, at)
    return None


def after(phases: NDArray[Any], at: float, t: float) -> NDArray[Any]:
    """Return the phases from an instant ``at`` on, begun at ``t`` instead."""
    k = max(int(np.searchsorted(phases["t"], at, side="right")) - 1, 0)
    rest = phases[k:].copy()
    end = float(rest["t"][0] + rest["duration"][0])
    rest[0] = states_at(phases, np.array([at]))[0]
    rest["duration"][0] = max(end - at, 0.0)
    rest["t"] += t - at
    return rest[rest["duration"] > 0.0]


class Ahead:
    """Another plan, seen from a place that it passes: ``begin`` is when it does."""

    def __init__(self, road: Road, other: NDArray[Any], place: Place) -> None:
        self._other, self._place = other, place
        self._starts = np.cumsum(road.segments["length"][place.row - road.base :])
        ways = self._ways(other)
        k = max(int(np.searchsorted(ways, 0.0, side="right")) - 1, 0)
        low, high = float(other["t"][k]), float(other["t"][k] + other["duration"][k])
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.way(middle) <= 0.0 else (low, middle)
        self.begin = low

    def _ways(self, states: NDArray[Any]) -> NDArray[np.float64]:
        rows = states["segment"].astype(np.int64) - self._place.row
        starts = np.where(rows > 0, self._starts[np.clip(rows - 1, 0, len(self._starts) - 1)], 0.0)
        return np.where(rows < 0, -np.inf, starts + states["s"] - self._place.s)

    def state(self, at: float) -> NDArray[Any]:
        """Return the state at an instant of the plan's own time."""
        return states_at(self._other, np.array([at]))[0]

    def way(self, at: float) -> float:
        """Return how far behind the place the plan is at an instant."""
        return float(self._ways(states_at(self._other, np.array([at])))[0])


def _motion(state: NDArray[Any]) -> tuple[float, float]:
    return float(state["v"]), float(state["a"])


def _meet(state: NDArray[Any], ahead: Ahead, most: tuple[float, float], span: float) -> float | None:
    """Return when the other plan is where a ramp to its state of then leads; None where that is not within a span."""

    def off(at: float) -> float:
        return ahead.way(at) - sum(piece.way for piece in ramp(_motion(state), _motion(ahead.state(at)), *most))

    low, short = ahead.begin, True
    for k in range(1, _SEARCH + 1):
        high = ahead.begin + span * (k / _SEARCH) ** 2
        enough = off(high) >= 0.0
        if short and enough:
            begin, end = low, high
            for _ in range(50):
                middle = 0.5 * (begin + end)
                begin, end = (begin, middle) if off(middle) >= 0.0 else (middle, end)
            if off(end) <= _MET:  # else it jumps there: a state with a != 0 cannot be waited for
                return end
        low, short = high, not enough
    return None
