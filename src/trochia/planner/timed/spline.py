"""Splines by time: points are not gone through, but drawn towards.  In: points and slices of time.  Out: cubics.

The curve is the cubic B-spline of the points over the slices, with the first and the last point thrice, which adds a
slice before and one after: it begins and ends on them, at rest.  For even slices it passes its knots at
(X[n-1] + 4 X[n] + X[n+1]) / 6 with velocity (X[n+1] - X[n-1]) / 2T.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.planner.timed.pieces import Pieces

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_ENDS = 3  #: how often the first and last point count
_LONGEST = 8388.608  #: of three slices that follow each other [s]: 2^23 ms


def spline1(start: ArrayLike, points: ArrayLike, slice_time: float) -> Pieces:
    """Return the spline from ``start`` (n,) by the points (m, n) in even slices [s]; it lasts m + 2 of them."""
    return spline2(start, points, np.full(len(np.asarray(points)), slice_time))


def spline2(start: ArrayLike, points: ArrayLike, slices: ArrayLike) -> Pieces:
    """Return the spline from ``start`` (n,) by the points (m, n), each with its slice of time (m,) [s].

    The slice added before is as long as the first, that after as the last.

    Raises
    ------
    LimitError
        When a slice is not above 0, or three that follow each other are longer than 2^23 ms.
    """
    from scipy.interpolate import BSpline  # noqa: PLC0415 - scipy is loaded late

    spans = np.asarray(slices, dtype=np.float64)
    if not (spans > 0.0).all():
        raise LimitError("a spline's slice takes a time above zero", hint="Give TA or TM before the first point.")
    spans = np.concatenate([spans[:1], spans, spans[-1:]])
    if (spans[:-2] + spans[1:-1] + spans[2:] > _LONGEST).any():
        raise LimitError(f"three slices of a spline last at most {_LONGEST:g} s together")
    first, others = np.atleast_1d(np.asarray(start, np.float64)), np.asarray(points, np.float64)
    controls = np.vstack([np.tile(first, (_ENDS, 1)), others, np.tile(others[-1], (_ENDS - 1, 1))])
    inner = np.concatenate([[0.0], np.cumsum(spans)])
    outer = np.arange(_ENDS, 0, -1)
    knots = np.concatenate([-outer * spans[0], inner, inner[-1] + outer[::-1] * spans[-1]])
    curve = BSpline(knots, controls, 3)
    taylor = [np.asarray(curve(inner[:-1], nu=power)) / math.factorial(power) for power in range(4)]
    moves = np.clip(np.arange(len(spans)) - 1, 0, len(others) - 1)
    return Pieces(durations=spans, coefficients=np.stack(taylor, axis=1), moves=moves)
