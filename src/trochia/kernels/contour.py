"""Face of ``core/host/contour.h``: distance of recorded points from the commanded path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import lib, pointer

if TYPE_CHECKING:
    from numpy.typing import NDArray


def contour_distance(
    commanded: NDArray[np.float64], actual: NDArray[np.float64], *, window: int = 256
) -> NDArray[np.float64]:
    """Return the distance of each actual point from the path through the commanded ones (samples,).

    Parameters
    ----------
    commanded, actual
        Positions at the same times (samples, axes), 1 to 9 axes.
    window
        How many samples the search goes on along the path without coming nearer.

    Raises
    ------
    ValueError
        When shapes disagree or a position is no finite number.
    """
    if commanded.shape != actual.shape or commanded.ndim != 2 or not 1 <= commanded.shape[1] <= 9:
        raise ValueError(
            f"expected two arrays of one shape (samples, 1 to 9), not {commanded.shape} and {actual.shape}"
        )
    if not (np.isfinite(commanded).all() and np.isfinite(actual).all()):
        raise ValueError("positions must be finite numbers")
    distance = np.empty(len(actual))
    if not len(actual):
        return distance
    # A rest repeats a point; without the repeats the search walks over ground only.
    moved = (np.diff(commanded, axis=0) != 0).any(axis=1)
    path = np.ascontiguousarray(commanded[np.concatenate([[True], moved])], np.float64)
    at = np.concatenate([[0], np.cumsum(moved)]).astype(np.int64)
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    points = np.ascontiguousarray(actual, np.float64)
    lib.trochia_contour(
        pointer(path, "const double *"),
        pointer(arc, "const double *"),
        len(path),
        path.shape[1],
        pointer(points, "const double *"),
        pointer(at, "const int64_t *"),
        len(points),
        window,
        pointer(distance, "double *"),
    )
    return distance
