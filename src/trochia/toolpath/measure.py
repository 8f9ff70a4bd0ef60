"""What a program's own path measures.  In: a Toolpath without blends.  Out: lengths, counts, extents."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.toolpath.toolpath import SegmentKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.toolpath.toolpath import Toolpath


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
    """Return the size of a path built with ``blend=False`` (then each segment is one move, and exact)."""
    feed = programmed.is_feed
    linear = _moves_linear_axes(programmed)
    length = programmed.segments["length"]
    return Measure(
        moves=len(programmed),
        feed_moves=int(feed.sum()),
        feed_length=float(length[feed & linear].sum()),
        rapid_length=float(length[~feed & linear].sum()),
        extents=programmed.extents(),
        feed_extents=programmed.extents(feed),
    )


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
