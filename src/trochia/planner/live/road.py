"""The path as it comes.  In: stretches of a path, one after another.  Out: the rows in hand, by their number.

Rows count from the program's start; what lies behind is dropped when told so.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.layout import SEGMENT
from trochia.planner.live.rows import Reused, put

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.planner.rests import Rests
    from trochia.program import Program
    from trochia.toolpath import Toolpath


_FIRST = 16_384  #: segments that there is room for at least where stretches are built in place
_ROOM = 2  #: times what is needed at once, that memory is taken for


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Some segments of a path, in order, and the moves they belong to.

    That of a path built piece by piece is gone when the next one is asked for.

    Attributes
    ----------
    segments, pool
        As in a Toolpath (k,); coefficients stand in the pool in the order of their segments, ``data`` counts from
        anywhere before the first.
    moves, first_move
        Rows of MOVE that the segments' ``move`` counts in, and the number of the first since the program's start.
    rests, seconds
        Segment of this stretch that motion rests before (r,), and how long [s] (r,); k: after the last.
    start
        Where the path was built from (n,): of the first stretch, where the program begins.
    """

    segments: NDArray[Any]
    pool: NDArray[np.float64]
    moves: NDArray[Any]
    first_move: int
    rests: NDArray[np.uint64]
    seconds: NDArray[np.float64]
    start: NDArray[np.float64]

    @classmethod
    def of(cls, path: Toolpath, program: Program, rests: Rests) -> Stretch:
        """Return a whole path as one stretch."""
        return cls(segments=path.segments, pool=path.pool, moves=program.moves, first_move=0,
                   rests=rests.segments, seconds=rests.seconds, start=path.start)  # fmt: skip


class Place(NamedTuple):
    """Where on a road: row of the segment, and s in it."""

    row: int
    s: float


class Road:
    """Rows ``base`` up to ``end`` of a path whose stretches are taken as they are needed.

    They lie in memory with room behind them: what comes in is copied there once, what is dropped is only not looked at
    any more, and views that were given out stay as they are.  When the room is used up, what is in hand moves.

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
    segments, pool
        What is in hand, as in a Stretch; ``move`` counts from the program's start.

    Parameters
    ----------
    room
        That the stretches are built in, if they are: then their coefficients are built in the road's own memory.
    """

    def __init__(self, axes: str, stretches: Iterator[Stretch], room: kernel.Room | None = None) -> None:
        self.axes, self.start = axes, np.zeros(len(axes))
        self.base, self.ended = 0, False
        self.rests: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self.seconds: NDArray[np.float64] = np.zeros(0)
        self._source, self._in_place = stretches, room is not None
        if room is not None:
            room.keeper = self._tail
        self._count = _FIRST if room is not None else 0  # segments of the longest stretch
        self._memory = [Reused(dtype) for dtype in (SEGMENT, np.float64, np.uint32, np.float32)]
        self._still = 0
        self._moves: NDArray[Any] | None = None  # of a path that was there as a whole
        self._first = self._end = self._pool_end = 0  # of what is in hand, in the memory it lies in
        self._hold(np.zeros(0, dtype=SEGMENT), np.zeros(0))

    @classmethod
    def whole(cls, axes: str, stretch: Stretch) -> Road:
        """Return the road of a path that is there already; nothing of it is copied."""
        road = cls(axes, iter(()))
        road._end, road._pool_end, road.start = len(stretch.segments), len(stretch.pool), stretch.start
        road.rests, road.seconds = stretch.rests.astype(np.int64), stretch.seconds
        road._moves = stretch.moves
        road._hold(stretch.segments, stretch.pool)
        return road

    def _hold(self, segments: NDArray[Any], pool: NDArray[np.float64]) -> None:
        self._segments, self._pool = segments, pool
        room = len(segments) if self._moves is None else 0
        self._lines, self._power = self._memory[2].take(room), self._memory[3].take(room)
        self._show()

    def _show(self) -> None:
        self.segments: NDArray[Any] = self._segments[self._first : self._end]
        self.pool: NDArray[np.float64] = self._pool[: self._pool_end]

    @property
    def end(self) -> int:
        """Number of the row after the last in hand; a road on which nothing moves has none, but a line of no length."""
        return self.base + len(self.segments) - self._still

    def lines(self, first: int, end: int) -> NDArray[np.uint32]:
        """Return the source lines of the rows ``first`` up to ``end`` (k,)."""
        if self._moves is not None:
            return self._moves["line"][self.rows(first, end)["move"]]
        return self._lines[self._first + first - self.base : self._first + end - self.base]

    def power(self, first: int, end: int) -> NDArray[np.float32]:
        """Return the power of the beam, or S of the spindle, of the rows ``first`` up to ``end`` (k,)."""
        if self._moves is not None:
            return self._moves["power"][self.rows(first, end)["move"]]
        return self._power[self._first + first - self.base : self._first + end - self.base]

    def rows(self, first: int, end: int) -> NDArray[Any]:
        """Return the segments of the rows ``first`` up to ``end`` (k,)."""
        return self.segments[first - self.base : end - self.base]

    def more(self) -> bool:
        """Take the next stretch; False when there is none."""
        stretch = next(self._source, None)
        if stretch is None:
            self._end_here()
            return False
        self.start = stretch.start if self.end == 0 else self.start
        if len(stretch.rests):
            self.rests = np.concatenate([self.rests, stretch.rests.astype(np.int64) + self.end])
            self.seconds = np.concatenate([self.seconds, stretch.seconds])
        count, size = len(stretch.segments), len(stretch.pool)
        if not count:
            return True
        low = int(stretch.segments["data"][0])
        at, here = self._pool_end + (low if self._in_place else 0), self._in_place
        if self._end + count > len(self._segments) or at + size > len(self._pool):
            self._move(count, size)
            at, here = self._pool_end, False
        if not here:
            self._pool[at : at + size] = stretch.pool
        new = slice(self._end, self._end + count)
        kernel.append(
            stretch.segments, stretch.moves, (self._segments[new], self._lines[new], self._power[new]),
            shift=at - low, first=stretch.first_move,
        )  # fmt: skip
        self._end, self._pool_end, self._count = self._end + count, at + size, max(count, self._count)
        self._show()
        return True

    def _tail(self, size: int) -> NDArray[np.float64]:
        """Return memory for so many coefficients behind those in hand: the next stretch is built there."""
        if self._pool_end + size > len(self._pool) or self._end + self._count > len(self._segments):
            self._move(self._count, size)
        return self._pool[self._pool_end :]

    def _move(self, count: int, size: int) -> None:
        """Move to memory with room for so many more segments and coefficients, and the same again."""
        held, low = len(self.segments), int(self.segments["data"][0]) if len(self.segments) else self._pool_end
        segments, pool = self.segments, self.pool[low:]
        lines, power = self.lines(self.base, self.base + held), self.power(self.base, self.base + held)
        self._first, self._end, self._pool_end = 0, held, len(pool)
        self._hold(self._memory[0].take(_ROOM * (held + count)), self._memory[1].take(_ROOM * (len(pool) + size)))
        put(segments, self.segments)
        self.segments["data"] -= np.uint64(low)
        self.pool[:], self._lines[:held], self._power[:held] = pool, lines, power

    def _end_here(self) -> None:
        self.ended = True
        if not len(self.segments):
            self._still, self._end = 1, 1
            self._pool_end = 2 * len(self.axes)
            self._hold(np.zeros(1, dtype=SEGMENT), np.concatenate([self.start, np.zeros(len(self.axes))]))
            self._lines[:], self._power[:] = 0, 0.0

    def trim(self, row: int) -> None:
        """Drop the rows before ``row``; of a path that is there as a whole nothing is."""
        if self._moves is not None:
            return
        self._first += row - self.base
        self.base = row
        self._show()
        if len(self.rests):
            kept = self.rests >= row
            self.rests, self.seconds = self.rests[kept], self.seconds[kept]

    def rests_between(self, first: int, end: int) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
        """Return the rests before rows ``first`` up to ``end``, counted from ``first``, and their times [s].

        That before ``end`` is among them where the program ends there.
        """
        last = self.ended and end == self.end
        inside = (self.rests >= first) & ((self.rests < end) | (last & (self.rests == end)))
        return (self.rests[inside] - first).astype(np.uint64), self.seconds[inside]
