"""A portion of motion that stands for itself: phases, and the segments they run on."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.layout import PHASE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from trochia.planner.live.road import Road
    from trochia.planner.live.rows import Reused


@dataclass(frozen=True, slots=True, kw_only=True)
class Portion:
    """Motion from ``begin`` to ``end``.

    Attributes
    ----------
    axes
        Letters of the columns.
    first
        Number of its first segment since the program's start.
    segments, pool
        As in a Toolpath; ``move`` counts from the program's start.
    lines, power
        Source line, and power of the beam or S of the spindle, of each segment (k,).
    phases
        (p,) of PHASE: t from the program's start, segments by the rows here.
    backwards
        Whether it backs up along the path; its segments then are those of the way back.
    """

    axes: str
    first: int
    segments: NDArray[Any]
    pool: NDArray[np.float64]
    lines: NDArray[np.uint32]
    power: NDArray[np.float32]
    phases: NDArray[Any]
    backwards: bool = False

    @classmethod
    def of(cls, road: Road, phases: NDArray[Any], *, backwards: bool = False, memory: Reused | None = None) -> Portion:
        """Return phases (of which there is at least one), counted by a road's rows, with what they need of it.

        Their copy lies in ``memory``, if there is any.
        """
        first, end = int(phases["segment"][0]), int(phases["segment"][-1]) + 1
        own = np.empty(len(phases), dtype=PHASE) if memory is None else memory.take(len(phases))[: len(phases)]
        kernel.move_phases(phases, own, rows=-first)
        return cls(
            axes=road.axes, first=first, segments=road.rows(first, end), pool=road.pool, lines=road.lines(first, end),
            power=road.power(first, end), phases=own, backwards=backwards,
        )  # fmt: skip

    @property
    def begin(self) -> float:
        """When it begins [s]."""
        return float(self.phases["t"][0])

    @property
    def end(self) -> float:
        """When it ends [s]."""
        return float(self.phases["t"][-1] + self.phases["duration"][-1])

    def states(self, times: ArrayLike) -> NDArray[Any]:
        """Return segment, s, v, a and j at each time [s], clamped to begin and end (times,) of PHASE."""
        return states_at(self.phases, np.atleast_1d(np.asarray(times, dtype=np.float64)))

    def derivative(self, times: ArrayLike, order: int) -> NDArray[np.float64]:
        """Return the axes' positions (order 0) or their derivatives (1 to 3) at each time (times, n)."""
        return kernel.sample(self.segments, self.pool, len(self.axes), self.states(times), order)

    def position(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' positions at each time (times, n) [mm, degree]."""
        return self.derivative(times, 0)

    def line_at(self, times: ArrayLike) -> NDArray[np.uint32]:
        """Return the source line whose move is under way at each time (times,)."""
        return self.lines[self.states(times)["segment"]]

    def power_at(self, times: ArrayLike) -> NDArray[np.float32]:
        """Return the power of the move under way at each time (times,), 0 in a rest."""
        states = self.states(times)
        return np.where(states["flags"] & 1 == 1, np.float32(0.0), self.power[states["segment"]])


def states_at(phases: NDArray[Any], times: NDArray[np.float64]) -> NDArray[Any]:
    """Return the state of motion at each time [s], clamped to the ends of the phases (times,) of PHASE."""
    rows = np.clip(np.searchsorted(phases["t"], times, side="right") - 1, 0, len(phases) - 1)
    states = phases[rows]
    tau = np.clip(times - states["t"], 0.0, states["duration"])
    return moved_on(states, tau, times)


def between(phases: NDArray[Any], begin: float, end: float) -> NDArray[Any]:
    """Return the phases from one instant to another (k,); those under way then begin or end there."""
    first = max(bisect_right(phases["t"], begin) - 2, 0)  # one more, as ends are where the next begins but for rounding
    near = phases[first : bisect_left(phases["t"], end)]
    kept = near[near["t"] + near["duration"] > begin]  # a copy
    if len(kept):
        until = float(kept["t"][0] + kept["duration"][0])
        at = max(begin, float(kept["t"][0]))
        kept[:1] = states_at(kept[:1], np.array([at]))
        kept["duration"][0] = until - at
        kept["duration"][-1] = min(float(kept["duration"][-1]), end - float(kept["t"][-1]))
    return kept


def moved_on(states: NDArray[Any], tau: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[Any]:
    """Return states (k,) of PHASE moved on by tau (k,) [s] each, and dated ``times``."""
    states = states.copy()
    states["s"] += tau * (states["v"] + tau * (states["a"] / 2 + tau * states["j"] / 6))
    states["v"] = np.maximum(states["v"] + tau * (states["a"] + tau * states["j"] / 2), 0.0)
    states["a"] += tau * states["j"]
    states["t"], states["duration"] = times, 0.0
    return states
