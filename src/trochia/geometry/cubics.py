"""A smooth plane curve as cubic Bezier curves.

In: a curve's points and derivatives by parameter, and a tolerance.  Out: control points.

Between two parameters stands the cubic with the curve's points and derivatives at both (Hermite), which is the curve
itself where that is a polynomial of degree three or less.  A stretch that comes out too far from the curve is halved;
the error falls with the fourth power of its length.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Evaluate = Callable[[Array], tuple[Array, Array]]

_DEEPEST = 12  # halvings of one stretch
_DIGITS = 1e-12  # of a coordinate that count
_SHARES = np.linspace(0.0, 1.0, 17)
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


def cubics(evaluate: Evaluate, spans: Sequence[float], tolerance: float) -> Array:
    """Return control points of cubics along a curve (k, 4, 2).

    Parameters
    ----------
    evaluate
        Points and derivatives (n, 2) by parameters (n,).
    spans
        Parameters between which the curve is smooth, its ends included.
    tolerance
        Greatest distance between a cubic and the curve, in the curve's unit.
    """
    pieces = [piece for low, high in pairwise(spans) for piece in _stretch(evaluate, low, high, tolerance, _DEEPEST)]
    return np.array(pieces).reshape(-1, 4, 2)


def _stretch(evaluate: Evaluate, low: float, high: float, tolerance: float, depth: int) -> Iterator[Array]:
    points, slopes = evaluate(low + (high - low) * _SHARES)
    third = (high - low) / 3.0
    control = np.array([points[0], points[0] + third * slopes[0], points[-1] - third * slopes[-1], points[-1]])
    away = np.abs(_at(control, _SHARES) - points).max()
    enough = max(0.7 * tolerance, _DIGITS * np.abs(points).max())  # of a diagonal, 0.7 is the whole
    if depth and away > enough and np.isfinite(away):
        middle = (low + high) / 2.0
        yield from _stretch(evaluate, low, middle, tolerance, depth - 1)
        yield from _stretch(evaluate, middle, high, tolerance, depth - 1)
    else:
        yield control


def _at(control: Array, shares: Array) -> Array:
    """Return points of a cubic (n, 2)."""
    t, rest = shares[:, None], 1.0 - shares[:, None]
    return rest**3 * control[0] + 3 * rest**2 * t * control[1] + 3 * rest * t**2 * control[2] + t**3 * control[3]


def lengths(control: Array) -> Array:
    """Return the lengths of cubics (k,) with control points (k, 4, d), by Gauss and Legendre."""
    steps = 3.0 * np.diff(control, axis=1)
    t = (0.5 * (_NODES + 1.0))[:, None, None]
    slope = (1 - t) ** 2 * steps[:, 0] + 2 * (1 - t) * t * steps[:, 1] + t**2 * steps[:, 2]
    return 0.5 * _WEIGHTS @ np.linalg.norm(slope, axis=2)
