"""A path of a million segments is two arrays.  In: segments and their coefficients.  Out: points, lengths, extents."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.layout import PHASE

if TYPE_CHECKING:
    from numpy.typing import NDArray


class SegmentKind(IntEnum):
    """The curve of a segment; ``core/host/path.h`` gives the coefficients of each."""

    LINE = 0
    ARC = 1
    CUBIC = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Toolpath:
    """The commanded path of one program.

    Attributes
    ----------
    axes
        Letters of the path's columns.
    start
        Where it begins (n,) [mm, degree].
    segments
        Rows of :data:`SEGMENT` (k,), read-only; ``move`` leads back to the program's row and so to its source line.
    pool
        Coefficients of all segments, read-only.
    merged
        Number of moves that another stands for, being in line with it within Q of G64.
    """

    axes: str
    start: NDArray[np.float64]
    segments: NDArray[Any]
    pool: NDArray[np.float64]
    merged: int = 0

    def __post_init__(self) -> None:
        kernel.check(self.segments, self.pool, len(self.axes))
        for array in (self.start, self.segments, self.pool):
            array.setflags(write=False)

    def __len__(self) -> int:
        """Return the number of segments."""
        return len(self.segments)

    @property
    def length(self) -> float:
        """Sum of the segments' ranges of s [mm; degrees where only rotary axes move]."""
        return float(self.segments["length"].sum())

    @property
    def is_feed(self) -> NDArray[np.bool_]:
        """Which segments have a programmed speed (k,); the others are rapids."""
        return np.isfinite(self.segments["speed_limit"])

    def points(
        self, rows: NDArray[np.integer[Any]], s: NDArray[np.float64], derivative: int = 0
    ) -> NDArray[np.float64]:
        """Return x, x' or x'' (derivative 0, 1, 2; by s) at ``s`` of the given segments, (k, n).

        Raises
        ------
        ValueError
            For another derivative, or a segment that is not there.
        """
        if not 0 <= derivative <= 2 or (rows.size and not 0 <= int(rows.min()) <= int(rows.max()) < len(self)):
            raise ValueError("points are asked for of segments of the path, with derivative 0 to 2")
        states = np.zeros(len(rows), dtype=PHASE)
        states["segment"], states["s"], states["v"] = rows, s, 1.0
        return kernel.sample(self.segments, self.pool, len(self.axes), states, derivative)

    def extents(self, only: NDArray[np.bool_] | None = None) -> NDArray[np.float64]:
        """Return the least and greatest position of each axis (2, n) [mm, degree], exactly.

        Parameters
        ----------
        only
            Which segments count (k,); None takes all, and the start.  Without any the bounds are +inf and -inf.
        """
        rows = self.segments if only is None else self.segments[only]
        bounds = np.array([[np.inf], [-np.inf]]) * np.ones(len(self.axes))
        if only is None:
            bounds = np.stack([self.start, self.start])
        kernel.extents(rows, self.pool, (0, len(rows)), bounds)
        return bounds
