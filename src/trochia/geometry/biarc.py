"""A smooth plane curve as arcs that touch each other with one tangent.

In: a curve's points and tangents by parameter, a tolerance.  Out: arcs and lines no farther from the curve than that.

Between two points with their tangents stand two arcs whose ends are equally long lines to the corner of their tangents:
K. M. Bolton, Biarc curves, Computer-Aided Design 7 (1975) 89-92.  A stretch that comes out too far from the curve is
halved.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import atan2, cos, hypot, pi, sqrt, tau
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Evaluate = Callable[[Array], tuple[Array, Array]]

Vector = tuple[float, float]

_DEEPEST = 24  # halvings of one stretch
_FLAT = 1e-9  # chord heights below this share of the chord are a line
_WIDEST = cos(pi / 3)  # tangents of one biarc may turn by less than this angle
_SAMPLES = np.linspace(0.0, 1.0, 11)
_NEAR = 1e-6  # of a stretch, from a point at which the curve stands still


@dataclass(frozen=True, slots=True)
class Piece:
    """An arc or a line: where it ends; its centre (None: a line), its sense (+1 counter-clockwise), its length."""

    end: Vector
    centre: Vector | None
    sense: int
    length: float


def biarcs(evaluate: Evaluate, spans: Sequence[float], tolerance: float) -> list[Piece]:
    """Return arcs and lines along a curve.

    Parameters
    ----------
    evaluate
        Points and derivatives (k, 2) by parameters (k,).
    spans
        Parameters between which the curve is smooth, its ends included.
    tolerance
        Greatest distance between curve and arcs, in the curve's unit.
    """
    pieces: list[Piece] = []
    for low, high in pairwise(spans):
        pieces.extend(_stretch(evaluate, low, high, tolerance, _DEEPEST))
    return pieces


def _stretch(evaluate: Evaluate, low: float, high: float, tolerance: float, left: int) -> Iterator[Piece]:
    """Yield the pieces of one stretch."""
    u = low + (high - low) * _SAMPLES
    points, slopes = evaluate(u)
    size = float(np.ptp(points, axis=0).max())
    start, end = _vector(points[0]), _vector(points[-1])
    if size <= 0.25 * tolerance:  # too small for its tangents to mean anything, as at a cusp
        if start != end:
            yield Piece(end, None, 0, hypot(end[0] - start[0], end[1] - start[1]))
        return
    first, last = _direction(evaluate, low, high, slopes[0]), _direction(evaluate, high, low, slopes[-1])
    pieces = _biarc(start, first, end, last)
    if left and (pieces is None or _farthest(start, pieces, points) > 0.5 * tolerance):
        middle = 0.5 * (low + high)
        yield from _stretch(evaluate, low, middle, tolerance, left - 1)
        yield from _stretch(evaluate, middle, high, tolerance, left - 1)
    else:
        yield from pieces or [Piece(end, None, 0, hypot(end[0] - start[0], end[1] - start[1]))]


def _vector(row: Array) -> Vector:
    return float(row[0]), float(row[1])


def _direction(evaluate: Evaluate, at: float, other: float, slope: Array) -> Vector:
    """Return the unit tangent at a parameter; where the curve stands still, that of the chord to a point close by."""
    size = float(np.hypot(slope[0], slope[1]))
    if size == 0.0:
        points, _ = evaluate(np.array([at, at + _NEAR * (other - at)]))
        slope = (points[1] - points[0]) * (1.0 if other > at else -1.0)
        size = float(np.hypot(slope[0], slope[1])) or 1.0
    return float(slope[0]) / size, float(slope[1]) / size


def _biarc(start: Vector, first: Vector, end: Vector, last: Vector) -> list[Piece] | None:
    """Return the two arcs between points with tangents; None where these turn too far."""
    across = end[0] - start[0], end[1] - start[1]
    together = _dot(first, last)
    chord = _dot(across, across)
    ahead = _dot(across, (first[0] + last[0], first[1] + last[1]))
    if together < _WIDEST or ahead <= 0.0 or _dot(across, first) <= 0.0 or _dot(across, last) <= 0.0:
        return None
    bend = 2.0 * (1.0 - together)  # chord = 2 d ahead + d^2 bend, for the length d of the four lines
    reach = chord / (ahead + sqrt(ahead * ahead + bend * chord))
    joint = (
        0.5 * (start[0] + end[0] + reach * (first[0] - last[0])),
        0.5 * (start[1] + end[1] + reach * (first[1] - last[1])),
    )
    there = _arc(start, first, joint)
    back = _arc(end, (-last[0], -last[1]), joint)
    return [there, Piece(end, back.centre, -back.sense, back.length)]


def _arc(start: Vector, tangent: Vector, end: Vector) -> Piece:
    """Return the arc that leaves a point along a tangent and ends at another point."""
    across = end[0] - start[0], end[1] - start[1]
    height, chord = tangent[0] * across[1] - tangent[1] * across[0], hypot(*across)
    if abs(height) <= _FLAT * chord:
        return Piece(end, None, 0, chord)
    radius = chord * chord / (2.0 * height)  # signed: the centre lies to the left where it is positive
    centre = start[0] - tangent[1] * radius, start[1] + tangent[0] * radius
    angle = 2.0 * abs(atan2(height, _dot(tangent, across)))
    return Piece(end, centre, 1 if height > 0 else -1, angle * abs(radius))


def _farthest(start: Vector, pieces: list[Piece], points: Array) -> float:
    """Return how far the points of a stretch lie from its pieces, at most."""
    away = np.full(len(points), np.inf)
    for piece in pieces:
        away = np.minimum(away, _distances(start, piece, points))
        start = piece.end
    return float(away.max())


def _distances(start: Vector, piece: Piece, points: Array) -> Array:
    """Return the distance of points (k, 2) from a piece (k,)."""
    to_end = np.hypot(points[:, 0] - piece.end[0], points[:, 1] - piece.end[1])
    ends = np.minimum(to_end, np.hypot(points[:, 0] - start[0], points[:, 1] - start[1]))
    if piece.centre is None:
        along = np.array([piece.end[0] - start[0], piece.end[1] - start[1]])
        way = points - np.array(start)
        share = way @ along / max(float(along @ along), 1e-300)
        beside = np.abs(way[:, 0] * along[1] - way[:, 1] * along[0]) / max(float(np.hypot(*along)), 1e-300)
        return np.where((share >= 0) & (share <= 1), beside, ends)
    out = points - np.array(piece.centre)
    radius = hypot(start[0] - piece.centre[0], start[1] - piece.centre[1])
    begin = atan2(start[1] - piece.centre[1], start[0] - piece.centre[0])
    turned = ((np.arctan2(out[:, 1], out[:, 0]) - begin) * piece.sense) % tau
    inside = turned <= piece.length / radius
    return np.where(inside, np.abs(np.hypot(out[:, 0], out[:, 1]) - radius), ends)


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1]
