"""What a program's own path measures.  In: a Program, or its Toolpath without blends.  Out: lengths, counts, extents.

A whole program is measured in parts, so that the path of a million moves never stands in memory only to be measured:
touching fresh memory costs more than the arithmetic.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.toolpath.build import build
from trochia.toolpath.toolpath import SegmentKind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.program import Program
    from trochia.toolpath.toolpath import Toolpath

_PART = 16_384  #: moves at a time: their path stays in the cache


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """Size of a path.

    Attributes
    ----------
    moves, feed_moves
        Number of moves that move, and of those of them that have a feed.
    feed_length, rapid_length
        Way of the linear axes [mm].
    extents, feed_extents
        Least and greatest position (2, n) [mm, degree]: of all motion with the start, and of the feed moves (+inf, -inf
        where there are none).
    """

    moves: int
    feed_moves: int
    feed_length: float
    rapid_length: float
    extents: NDArray[np.float64]
    feed_extents: NDArray[np.float64]


def measure(programmed: Toolpath) -> Measure:
    """Return the size of a path built with ``blend=False`` (then no segment is of two moves, and all are exact)."""
    feed = programmed.is_feed
    linear = _moves_linear_axes(programmed)
    length, move = programmed.segments["length"], programmed.segments["move"]
    begins = np.ones(len(programmed), dtype=np.bool_)
    begins[1:] = move[1:] != move[:-1]
    return Measure(
        moves=int(begins.sum()),
        feed_moves=int((feed & begins).sum()),
        feed_length=float(length[feed & linear].sum()),
        rapid_length=float(length[~feed & linear].sum()),
        extents=programmed.extents(),
        feed_extents=programmed.extents(feed),
    )


def measure_program(program: Program, machine: Machine) -> Measure:
    """Return the size of a program's own path on a machine; errors are those of :func:`trochia.toolpath.build`."""
    parts = [measure(build(part, machine, blend=False)) for part in _parts(program)]
    return Measure(
        moves=sum(part.moves for part in parts),
        feed_moves=sum(part.feed_moves for part in parts),
        feed_length=sum(part.feed_length for part in parts),
        rapid_length=sum(part.rapid_length for part in parts),
        extents=_widest([part.extents for part in parts]),
        feed_extents=_widest([part.feed_extents for part in parts]),
    )


def _widest(bounds: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the bounds (2, n) of all bounds."""
    return np.stack([np.min([low for low, _ in bounds], axis=0), np.max([high for _, high in bounds], axis=0)])


def _parts(program: Program) -> Iterator[Program]:
    """Yield the program in parts of a bounded number of moves; one part at least.

    Actions are left out: they change the time, not the size.
    """
    start = program.start
    for first in range(0, max(len(program.moves), 1), _PART):
        moves = program.moves[first : first + _PART]
        yield replace(program, moves=moves, start=start, actions=())
        start = moves["target"][-1] if len(moves) else start


def _moves_linear_axes(path: Toolpath) -> NDArray[np.bool_]:
    """Return which segments are measured in mm (k,)."""
    linear = np.array([letter not in "ABC" for letter in path.axes])
    moving = np.ones(len(path), dtype=np.bool_)
    if linear.all():
        return moving
    lines = path.segments["kind"] == SegmentKind.LINE
    at = path.segments["data"][lines].astype(np.int64)[:, None] + len(path.axes) + np.flatnonzero(linear)
    moving[lines] = (np.abs(path.pool[at]).max(axis=1, initial=0.0) * path.segments["length"][lines]) > 1e-9
    return moving
