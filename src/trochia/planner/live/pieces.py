"""Segments cut and turned round.  In: rows of a path and their coefficients.  Out: the same curves from elsewhere.

``core/host/path.h`` says what the coefficients of each kind are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import SEGMENT
from trochia.toolpath.toolpath import SegmentKind

if TYPE_CHECKING:
    from numpy.typing import NDArray


def size_of(kind: int, axes: int) -> int:
    """Return how many coefficients a segment of a kind has."""
    return {SegmentKind.LINE: 2 * axes, SegmentKind.ARC: 7 + 2 * axes, SegmentKind.CUBIC: 4 * axes}[SegmentKind(kind)]


def shifted(kind: int, c: NDArray[np.float64], axes: int, s: float) -> NDArray[np.float64]:
    """Return the coefficients of a segment as it goes on from ``s``, with s counted from there."""
    out, n = c.copy(), axes
    if kind == SegmentKind.LINE:
        out[:n] += c[n:] * s
    elif kind == SegmentKind.CUBIC:
        c0, c1, c2, c3 = c.reshape(4, n)
        out[:n] = c0 + s * (c1 + s * (c2 + s * c3))
        out[n : 2 * n] = c1 + s * (2 * c2 + s * 3 * c3)
        out[2 * n : 3 * n] = c2 + 3 * c3 * s
    else:
        curve = c[6 + 2 * n]
        out[2] += c[5] * s
        out[3] += s * (c[4] + curve * s)
        out[4] += 2 * curve * s
        out[6 : 6 + n] += c[6 + n : 6 + 2 * n] * s
    return out


def turned(kind: int, c: NDArray[np.float64], axes: int, length: float) -> NDArray[np.float64]:
    """Return the coefficients of a segment of this length gone through from its end to its start."""
    out, n = shifted(kind, c, axes, length), axes
    if kind == SegmentKind.LINE:
        out[n:] *= -1.0
    elif kind == SegmentKind.CUBIC:
        out[n : 2 * n] *= -1.0
        out[3 * n :] *= -1.0
    else:
        out[4:6] *= -1.0
        out[6 + n : 6 + 2 * n] *= -1.0
    return out


def cut_head(
    rows: NDArray[Any], pool: NDArray[np.float64], axes: int, s: float
) -> tuple[NDArray[Any], NDArray[np.float64]]:
    """Return a path without the first ``s`` of its first segment: the rows changed in place, a pool of its own."""
    if s <= 0.0:
        return rows, pool
    at, kind = int(rows["data"][0]), int(rows["kind"][0])
    head = shifted(kind, pool[at : at + size_of(kind, axes)], axes, s)
    rows["data"][0] = len(pool)
    rows["length"][0] -= s
    return rows, np.concatenate([pool, head])


def reversed_path(
    segments: NDArray[Any],
    pool: NDArray[np.float64],
    axes: int,
    start: tuple[int, float],
    end: tuple[int, float],
) -> tuple[NDArray[Any], NDArray[np.float64]]:
    """Return the path back from ``start`` to ``end``, which lies before it; both are (row, s).

    Rows come out in the order they are gone through; s counts from where each is entered.
    """
    (last, high), (first, low) = start, end
    rows: list[NDArray[Any]] = []
    coefficients: list[NDArray[np.float64]] = []
    at = 0
    last, high = (last, high) if high > 0.0 or last == first else (last - 1, np.inf)
    for row in range(last, first - 1, -1):
        segment = segments[row : row + 1].copy()
        kind, data = int(segment["kind"][0]), int(segment["data"][0])
        from_s = low if row == first else 0.0
        length = min(high if row == last else np.inf, float(segment["length"][0])) - from_s
        if length <= 0.0:
            continue
        c = shifted(kind, pool[data : data + size_of(kind, axes)], axes, from_s)
        coefficients.append(turned(kind, c, axes, length))
        segment["length"], segment["data"] = length, at
        segment["stop"] = row == first or segments["stop"][row - 1]
        at += len(coefficients[-1])
        rows.append(segment)
    if not rows:
        return np.zeros(0, dtype=SEGMENT), np.zeros(0)
    return np.concatenate(rows), np.concatenate(coefficients)
