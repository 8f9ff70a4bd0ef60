"""The path as it comes.  In: stretches of a path, one after another.  Out: the rows in hand, by their number.

Rows count from the program's start; what lies behind is dropped when told so.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.kernels.layout import SEGMENT
from trochia.planner.live.pieces import rows_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.planner.rests import Rests
    from trochia.program import Program
    from trochia.toolpath import Toolpath


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Some segments of a path, in order, each with its source line and the power of its move.

    Attributes
    ----------
    segments, pool
        As in a Toolpath; ``move`` counts from the program's start.
    lines, power
        Of each segment (k,).
    rests, seconds
        Segment of this stretch that motion rests before (r,), and how long [s] (r,); k: after the last.
    start
        Where the path was built from (n,): of the first stretch, where the program begins.
    """

    segments: NDArray[Any]
    pool: NDArray[np.float64]
    lines: NDArray[np.uint32]
    power: NDArray[np.float32]
    rests: NDArray[np.uint64]
    seconds: NDArray[np.float64]
    start: NDArray[np.float64]

    @classmethod
    def of(cls, path: Toolpath, program: Program, rests: Rests) -> Stretch:
        """Return a whole path as one stretch."""
        moves = path.segments["move"]
        return cls(segments=path.segments, pool=path.pool, lines=program.moves["line"][moves],
                   power=program.moves["power"][moves], rests=rests.segments, seconds=rests.seconds,
                   start=path.start)  # fmt: skip


class Place(NamedTuple):
    """Where on a road: row of the segment, and s in it."""

    row: int
    s: float


class Road:
    """Rows ``base`` up to ``end`` of a path whose stretches are taken as they are needed.

    Attributes
    ----------
    axes
        Letters of the path's columns.
    start
        Where the program begins (n,), once a stretch is taken.
    base
        Number of the first row in hand.
    ended
        Whether the last row in hand is the program's last.
    """

    def __init__(self, axes: str, stretches: Iterator[Stretch]) -> None:
        self.axes, self.start = axes, np.zeros(len(axes))
        self.base, self.ended = 0, False
        self.segments: NDArray[Any] = np.zeros(0, dtype=SEGMENT)
        self.pool: NDArray[np.float64] = np.zeros(0)
        self.lines: NDArray[np.uint32] = np.zeros(0, dtype=np.uint32)
        self.power: NDArray[np.float32] = np.zeros(0, dtype=np.float32)
        self.rests: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self.seconds: NDArray[np.float64] = np.zeros(0)
        self._source = stretches
        self._still = 0

    @property
    def end(self) -> int:
        """Number of the row after the last in hand; a road on which nothing moves has none, but a line of no length."""
        return self.base + len(self.segments) - self._still

    def more(self) -> bool:
        """Take the next stretch; False when there is none."""
        stretch = next(self._source, None)
        if stretch is None:
            self._end_here()
            return False
        rows, end = stretch.segments, self.end
        self.start = stretch.start if end == 0 else self.start
        if len(self.segments):
            rows = rows.copy()
            rows["data"] += np.uint64(len(self.pool))
            self.segments = np.concatenate([self.segments, rows])
            self.pool = np.concatenate([self.pool, stretch.pool])
            self.lines = np.concatenate([self.lines, stretch.lines])
            self.power = np.concatenate([self.power, stretch.power])
        else:
            self.segments, self.pool, self.lines, self.power = rows, stretch.pool, stretch.lines, stretch.power
        self.rests = np.concatenate([self.rests, stretch.rests.astype(np.int64) + end])
        self.seconds = np.concatenate([self.seconds, stretch.seconds])
        return True

    def _end_here(self) -> None:
        self.ended = True
        if not len(self.segments):
            self._still = 1
            self.segments = np.zeros(1, dtype=SEGMENT)
            self.pool = np.concatenate([self.start, np.zeros(len(self.axes))])
            self.lines, self.power = np.zeros(1, dtype=np.uint32), np.zeros(1, dtype=np.float32)

    def trim(self, row: int) -> None:
        """Drop the rows before ``row``, once they are half of what is in hand."""
        drop = row - self.base
        if 2 * drop <= len(self.segments):
            return
        self.segments, pool = rows_of(self.segments, self.pool, drop, len(self.segments), len(self.axes))
        self.pool = pool.copy()
        self.lines, self.power = self.lines[drop:].copy(), self.power[drop:].copy()
        kept = self.rests >= row
        self.rests, self.seconds, self.base = self.rests[kept], self.seconds[kept], row

    def slice(self, first: int, end: int) -> tuple[NDArray[Any], NDArray[np.float64]]:
        """Return copies of rows ``first`` up to ``end``, and a view of their coefficients."""
        return rows_of(self.segments, self.pool, first - self.base, end - self.base, len(self.axes))

    def rests_between(self, first: int, end: int) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
        """Return the rests before rows ``first`` up to ``end``, counted from ``first``, and their times [s].

        That before ``end`` is among them where the program ends there.
        """
        last = self.ended and end == self.end
        inside = (self.rests >= first) & ((self.rests < end) | (last & (self.rests == end)))
        return (self.rests[inside] - first).astype(np.uint64), self.seconds[inside]
