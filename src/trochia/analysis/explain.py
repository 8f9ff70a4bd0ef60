"""Where the time goes and why.  In: a plan.  Out: seconds by the limit that binds, for the whole and for each line.

Every phase of the motion is looked at in a few places; each stands for its part of the phase's time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.planner.binding import ROWS, Kind, word

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan
    from trochia.planner import Trajectory

    Floats = NDArray[np.float64]

_BLOCK = 8192
_FEW_PHASES = 100_000  #: up to so many, each is looked at in eight places, beyond in two
_CODES = ROWS * len(Kind)
_EVEN = 1e-9  #: a change of speed below this part of it is none
_STILL = 1e-9  #: a speed below this part of the greatest is none
_LINE_LIMITS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """Time that one limit binds.

    Attributes
    ----------
    code
        Kind and row (see :class:`trochia.planner.Binding`), as one number.
    limit
        In words.
    seconds, beside_stops
        How long it binds [s], and how much of that while motion leaves a standstill or comes to one [s].
    used
        How much of the limit is used on average while it binds, 1 all.
    """

    code: int
    limit: str
    seconds: float
    beside_stops: float
    used: float

    @property
    def kind(self) -> Kind:
        """What kind of limit."""
        return Kind(self.code // ROWS)

    def figures(self) -> dict[str, Any]:
        """Return what a script gets."""
        return {
            "limit": self.limit, "kind": self.kind.name.lower(), "time_s": self.seconds,
            "beside_stops_s": self.beside_stops, "used": self.used,
        }  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """Which limits cost the time of a plan.

    Attributes
    ----------
    shares
        The limits that bind at all, the costliest first; rests are one of them.
    stops
        Begin and end of each stretch in which motion leaves a standstill or comes to one (n, 2) [s].
    lines, codes, seconds
        Time by source line and code (m,) [s], ordered by line; rests are left out.
    names
        Of the rows of limits.
    """

    shares: tuple[Share, ...]
    stops: Floats
    lines: NDArray[np.int64]
    codes: NDArray[np.int64]
    seconds: Floats
    names: tuple[str, ...]

    def beside_stop(self, times: Floats) -> NDArray[np.bool_]:
        """Return whether motion leaves a standstill, or comes to one, at each time (times,)."""
        at = np.searchsorted(self.stops[:, 0], times, side="right") - 1
        return (at >= 0) & (times <= self.stops[np.maximum(at, 0), 1]) if len(self.stops) else at >= 0

    def of_line(self, line: int) -> list[tuple[str, float]]:
        """Return the limits that bind in a source line and their seconds, the costliest first."""
        low, high = np.searchsorted(self.lines, [line, line + 1])
        order = low + np.argsort(-self.seconds[low:high], kind="stable")
        return [(word(int(self.codes[i]), self.names), float(self.seconds[i])) for i in order]

    def figures(self) -> dict[str, Any]:
        """Return what `trochia plan --explain --json` adds."""
        return {"binding": [share.figures() for share in self.shares]}

    def line_figures(self, line: int) -> list[dict[str, Any]]:
        """Return what binds in a line, for a script."""
        return [{"limit": limit, "time_s": seconds} for limit, seconds in self.of_line(line)[:_LINE_LIMITS]]


def explain(plan: Plan) -> Explanation:
    """Return which limits cost the time of a plan."""
    trajectory = plan.trajectory
    near, count = _beside_stops(trajectory), 0
    points = 8 if len(near) <= _FEW_PHASES else 2
    total = np.zeros((3, _CODES))  # seconds, beside stops, seconds times what is used
    stops: list[Floats] = []
    keys: list[NDArray[np.int64]] = []
    sums: list[Floats] = []
    for phases in trajectory.planned_blocks(_BLOCK):
        beside = near[count : count + len(phases)]
        count += len(phases)
        stops.append(np.stack([phases["t"], phases["t"] + phases["duration"]], axis=1)[beside])
        binding = trajectory.binding_of(_inside(phases, points))
        code, part = binding.code, np.repeat(phases["duration"] / points, points)
        for row, weight in enumerate((part, part * np.repeat(beside, points), part * binding.used)):
            total[row] += np.bincount(code, weight, _CODES)
        if trajectory.schedule is not None:
            moving = code >= ROWS
            line = plan.program.moves["line"][trajectory.path.segments["move"][np.repeat(phases["segment"], points)]]
            key, place = np.unique(line[moving].astype(np.int64) * _CODES + code[moving], return_inverse=True)
            keys.append(key)
            sums.append(np.bincount(place, part[moving], len(key)).astype(np.float64))
    if trajectory.shaping is not None:
        total[0, Kind.SHAPER * ROWS] = trajectory.shaping.delay
    key, place = np.unique(np.concatenate([*keys, np.zeros(0, np.int64)]), return_inverse=True)
    names = trajectory.limits.names
    return Explanation(
        shares=_shares(total, names), stops=_joined(stops), lines=key // _CODES, codes=key % _CODES,
        seconds=np.bincount(place, np.concatenate([*sums, np.zeros(0)]), len(key)).astype(np.float64), names=names,
    )  # fmt: skip


def _shares(total: Floats, names: tuple[str, ...]) -> tuple[Share, ...]:
    """Return the limits that bind at all, the costliest first."""
    order = [int(code) for code in np.argsort(-total[0], kind="stable") if total[0, code] > 0.0]
    return tuple(
        Share(code=code, limit=word(code, names), seconds=float(total[0, code]), beside_stops=float(total[1, code]),
              used=float(total[2, code] / total[0, code]))
        for code in order
    )  # fmt: skip


def _inside(phases: NDArray[Any], points: int) -> NDArray[Any]:
    """Return the states in the middles of ``points`` equal parts of each phase."""
    states = np.repeat(phases, points)
    tau = np.tile((np.arange(points) + 0.5) / points, len(phases)) * states["duration"]
    states["s"] += tau * (states["v"] + tau * (states["a"] / 2 + tau * states["j"] / 6))
    states["v"] += tau * (states["a"] + tau * states["j"] / 2)
    states["a"] += tau * states["j"]
    states["t"] += tau
    return states


def _beside_stops(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Return whether each phase belongs to a rise of speed from rest, or to a fall to it (phases,)."""
    trends: list[NDArray[np.int8]] = []
    rests: list[NDArray[np.bool_]] = []
    top = 0.0
    for trend, first, last in _trends(trajectory):
        top = max(top, float(np.max(first, initial=0.0)), float(np.max(last, initial=0.0)))
        trends.append(trend)
        rests.append((first <= _STILL * top) | (last <= _STILL * top))
    if not trends:
        return np.zeros(0, dtype=np.bool_)
    trend, resting = np.concatenate(trends), np.concatenate(rests)
    run = np.cumsum(np.diff(trend, prepend=trend[:1]) != 0)
    return (np.bincount(run, resting, run[-1] + 1) > 0)[run] & (trend != 0)


def _trends(trajectory: Trajectory) -> Iterator[tuple[NDArray[np.int8], Floats, Floats]]:
    """Yield of each block whether speed rises, stays or falls (1, 0, -1) in each phase, and its speeds at both ends."""
    for phases in trajectory.planned_blocks(_BLOCK):
        first, d = phases["v"], phases["duration"]
        last = np.maximum(first + d * (phases["a"] + d * phases["j"] / 2), 0.0)
        change = last - first
        trend = np.sign(change) * (np.abs(change) > _EVEN * (first + last))
        yield trend.astype(np.int8), first, last


def _joined(stops: list[Floats]) -> Floats:
    """Return stretches of time (n, 2), those that touch joined."""
    spans = np.concatenate([*stops, np.zeros((0, 2))])
    if not len(spans):
        return spans
    opens = np.concatenate([[True], spans[1:, 0] > spans[:-1, 1] + _EVEN * (1.0 + spans[:-1, 1])])
    closes = np.concatenate([opens[1:], [True]])
    return np.stack([spans[opens, 0], spans[closes, 1]], axis=1)
