"""Face of ``core/host/spline.h``: Bezier curves into cubics by their own length.

In: control points.  Out: pieces, and which are whose.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import dtype_of, lib, pointer

if TYPE_CHECKING:
    from numpy.typing import NDArray

PIECE = dtype_of("trochia_spline_piece")
_GUESS = 16  #: pieces a curve; where that is too few, the work is done once more


def fit(points: NDArray[np.float64], tolerance: float) -> tuple[NDArray[np.void], NDArray[np.uint64]]:
    """Return pieces (k,) of PIECE, and the first piece of each curve and one past the last (curves + 1,).

    Parameters
    ----------
    points
        Control points of cubic Bezier curves (curves, 4, 3) [mm].
    tolerance
        Greatest distance of a piece from its curve [mm].
    """
    if points.shape[1:] != (4, 3) or points.dtype != np.float64 or not tolerance > 0.0 or not np.isfinite(points).all():
        raise ValueError("splines are finite control points (k, 4, 3), their tolerance is positive")
    held = np.ascontiguousarray(points)
    first = np.zeros(len(held) + 1, dtype=np.uint64)
    room, total = 0, _GUESS * len(held)
    pieces = np.empty(0, dtype=PIECE)
    while total > room:
        room = total
        pieces = np.empty(room, dtype=PIECE)
        total = lib.trochia_spline_fit(
            pointer(held, "double *"), len(held), tolerance, pointer(first, "uint64_t *"),
            pointer(pieces, "trochia_spline_piece *"), room,
        )  # fmt: skip
    pieces.resize(total, refcheck=False)
    return pieces, first
