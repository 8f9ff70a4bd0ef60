"""The quickest stop along the path.  In: the motion in hand, an instant.  Out: the motion that comes to rest.

There is always a stop in hand: the motion in hand itself, which ends at rest.  A better one is a ramp to rest from some
instant on, taken only when it keeps every limit along all of its way; from instants on its way still better ones are
looked for.  Where acceleration along the path jumps (behind an overlap of two moves) a stop is looked for at that very
instant: a little later motion may be too fast to stop before the next corner.  So whatever the path does, every motion
that is begun has been looked at to its end.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.planner.live.laid import keeps, lay
from trochia.planner.live.portion import states_at
from trochia.planner.live.road import Place
from trochia.planner.ramp import ramp

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.planner.live.road import Road
    from trochia.planner.live.window import Rules

#: parts of what a straight line would allow that are tried, the strongest first
STRENGTHS = (1.4, 1.2, 1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.12, 0.06)
_INSTANTS = 48  #: in a worst stopping time at which a better stop is looked for
_APART = 1e-9  #: s: sooner than that is the same instant


def strengths(road: Road, rules: Rules, state: NDArray[Any]) -> Iterator[tuple[float, float]]:
    """Yield greatest a and da/dt to try from a state on: parts of what the direction there allows."""
    at = state.reshape(1).copy()
    at["segment"] -= np.uint32(road.base)
    at["v"], at["a"], at["j"] = 1.0, 0.0, 0.0
    along = kernel.sample(road.segments, road.pool, len(road.axes), at, 1)[0]
    limits = rules.limits
    rows, vector = np.abs(limits.matrix @ along), float(np.linalg.norm(along[: limits.linear]))
    bend = max(float((rows / limits.acceleration).max()), vector / limits.path_acceleration)
    shake = max(float((rows / limits.jerk).max()), vector / limits.path_jerk) if rules.jerk_limited else 0.0
    most_j = 1.0 / shake if shake > 0.0 else float("inf")
    for part in STRENGTHS:
        yield part / bend, part * most_j


def stop_from(road: Road, rules: Rules, state: NDArray[Any], feed: float, within: float) -> NDArray[Any] | None:
    """Return the phases of the strongest stop from a state that keeps all limits, if it takes less than a time [s]."""
    here, place = (float(state["v"]), float(state["a"])), Place(int(state["segment"]), float(state["s"]))
    for most_a, most_j in strengths(road, rules, state):
        pieces = ramp(here, (0.0, 0.0), most_a, most_j)
        if sum(piece.duration for piece in pieces) >= within:
            return None
        phases = lay(road, place, pieces, float(state["t"]))
        if phases is not None and keeps(road, rules, phases, feed):
            return phases
    return None


def hold(road: Road, rules: Rules, phases: NDArray[Any], t: float, feed: float) -> NDArray[Any]:
    """Return the phases in hand up to ``t`` and from there to rest, as soon as can be.

    Parameters
    ----------
    phases
        Motion on the road, to rest at its end (k,) of PHASE.
    feed
        Override of programmed feeds that the motion keeps.
    """
    best = phases[: _rest_after(phases, t)]
    if best["flags"][-1] & 1:
        return before(best, max(t, float(best["t"][-1])))
    end, step = _end(best), rules.stopping_time / _INSTANTS
    if states_at(best, np.array([t]))[0]["v"] == 0.0:
        return before(best, t)
    instant, jumps = t, kicks(best) if rules.jerk_limited else np.zeros(0)
    while instant < end - 1e-9:
        state = states_at(best, np.array([instant]))[0]
        stop = stop_from(road, rules, state, feed, end - instant - 1e-9)
        if stop is not None:
            best = np.concatenate([before(best, instant), stop])
            end = _end(best)
        instant = following(jumps, instant, step)
    return best


def before(phases: NDArray[Any], t: float) -> NDArray[Any]:
    """Return the phases up to an instant, at least one; that which is under way then ends there."""
    count = int(np.searchsorted(phases["t"], t, side="left"))
    kept = phases[: max(count, 1)].copy()
    kept["duration"][-1] = min(float(kept["duration"][-1]), max(t - float(kept["t"][-1]), 0.0))
    return kept


def following(jumps: NDArray[np.float64], instant: float, step: float) -> float:
    """Return the next instant: a step later, or at a jump of acceleration before."""
    sooner = jumps[(jumps > instant + _APART) & (jumps < instant + step)]
    return float(sooner[0]) if len(sooner) else instant + step


def kicks(phases: NDArray[Any]) -> NDArray[np.float64]:
    """Return when acceleration along the path jumps (k,) [s]."""
    ends = phases["a"] + phases["duration"] * phases["j"]
    small = 1e-6 * float(np.abs(phases["a"]).max(initial=0.0))
    return phases["t"][1:][np.abs(phases["a"][1:] - ends[:-1]) > small]


def _end(phases: NDArray[Any]) -> float:
    return float(phases["t"][-1] + phases["duration"][-1])


def _rest_after(phases: NDArray[Any], t: float) -> int:
    """Return how many phases lead to the first rest at or after ``t``."""
    ends = phases["t"] + phases["duration"]
    still = np.append(phases["v"][1:] == 0.0, np.True_) | (phases["flags"] & 1 == 1)
    found = np.flatnonzero(still & (ends >= t))
    return int(found[0]) + 1 if len(found) else len(phases)
