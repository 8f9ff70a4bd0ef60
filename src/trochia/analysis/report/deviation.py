"""How far beside the path the machine was, with direction: what the report exaggerates to make errors visible.

In: commanded and actual positions, sample by sample.  Out: the vector from the nearest commanded point to the actual
one.  Lag along the path is not in it: the nearest point is one that was commanded a little earlier.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Indices = NDArray[np.int64]

#: A loop lags by no more samples than this, and leads (by feed-forward) by no more than a quarter of it.
_LAG = 400


def deviation(position: Floats, actual: Floats, at: Indices) -> Floats:
    """Return ``actual[at]`` minus the nearest point of the commanded path (q, k).

    ``position`` and ``actual`` are (m, k), ``at`` (q,).  The search walks from the sample itself back in time, and
    forward, for as long as the path comes nearer, so that another pass at the same place is not mistaken for it.
    """
    target = actual[at]
    nearest = _walk(position, target, at, -1, _LAG)
    nearest = _walk(position, target, nearest, 1, _LAG // 4)
    before = _offset(position, target, nearest - 1, nearest)
    after = _offset(position, target, nearest, nearest + 1)
    closer = np.linalg.norm(before, axis=1) < np.linalg.norm(after, axis=1)
    return np.where(closer[:, None], before, after)


def _walk(position: Floats, target: Floats, start: Indices, step: int, most: int) -> Indices:
    """Return for each target the sample reached by walking from ``start`` while it comes no farther."""
    place = start.copy()
    best = np.linalg.norm(position[place] - target, axis=1)
    walking = np.arange(len(start))
    probe = start.copy()
    for _ in range(most):
        probe = np.clip(probe + step, 0, len(position) - 1)
        distance = np.linalg.norm(position[probe] - target[walking], axis=1)
        nearer = distance < best[walking]
        place[walking[nearer]] = probe[nearer]
        on = distance <= best[walking]
        best[walking[nearer]] = distance[nearer]
        walking, probe = walking[on], probe[on]
        if not len(walking):
            break
    return place


def _offset(position: Floats, target: Floats, first: Indices, last: Indices) -> Floats:
    """Return each target minus the nearest point of the chord between two samples (cut to those there are)."""
    end = len(position) - 1
    begin = position[np.clip(first, 0, end)]
    chord = position[np.clip(last, 0, end)] - begin
    square = np.sum(chord**2, axis=1)
    along = np.sum((target - begin) * chord, axis=1)
    share = np.clip(np.divide(along, square, out=np.zeros_like(along), where=square > 0), 0, 1)
    return target - begin - share[:, None] * chord
