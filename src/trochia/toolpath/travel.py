"""Whether a path stays inside the machine's travel.  In: a Toolpath, axes.  Out: the first excess, or a fitting shift.

A program is held to its travel by both its paths, the programmed and the commanded one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels import path as kernel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.machine.axes import Axis
    from trochia.toolpath.toolpath import Toolpath

_ROUNDING = 1e-9  #: mm or degree: a program that goes exactly to the end of travel stays inside


@dataclass(frozen=True, slots=True, kw_only=True)
class Outside:
    """One excess: the segment, the axis, where it goes [mm or degree] and by how much that is too far (signed)."""

    segment: int
    axis: str
    position: float
    excess: float


def _excess(bounds: NDArray[np.float64], axes: Sequence[Axis]) -> tuple[int, float, float] | None:
    """Return column, position and signed excess of the worst axis; None when all lie inside."""
    below = np.array([axis.minimum for axis in axes]) - bounds[0]
    above = bounds[1] - np.array([axis.maximum for axis in axes])
    column = int(np.argmax(np.maximum(below, above)))
    if max(below[column], above[column]) <= _ROUNDING:
        return None
    if above[column] >= below[column]:
        return column, float(bounds[1, column]), float(above[column])
    return column, float(bounds[0, column]), -float(below[column])


def first_outside(path: Toolpath, axes: Sequence[Axis]) -> Outside | None:
    """Return the first segment that leaves the travel of the axes (in the path's columns); None when none does."""

    def bounds(first: int, last: int) -> NDArray[np.float64]:
        found = np.array([[np.inf], [-np.inf]]) * np.ones(len(axes))
        kernel.extents(path.segments, path.pool, (first, last), found)
        return found

    low, high = 0, len(path)
    if not high or _excess(bounds(low, high), axes) is None:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if _excess(bounds(low, middle), axes) is None else (low, middle)
    worst = _excess(bounds(low, high), axes)
    assert worst is not None
    column, position, excess = worst
    return Outside(segment=low, axis=axes[column].name, position=position, excess=excess)


def fitting_shift(bounds: NDArray[np.float64], axes: Sequence[Axis]) -> NDArray[np.float64] | None:
    """Return the smallest shift (n,) [mm, degree] that brings bounds (2, n) into the travel; None when none can."""
    least = np.array([axis.minimum for axis in axes]) - bounds[0]
    greatest = np.array([axis.maximum for axis in axes]) - bounds[1]
    if (least > greatest).any():
        return None
    return np.clip(np.zeros(len(axes)), least, greatest)
