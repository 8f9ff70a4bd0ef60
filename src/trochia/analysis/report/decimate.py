"""Fewer points, same picture: bounded size whatever the length of the job.

In: columns of any length.  Out: at most a given number of rows, peaks and corners kept.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Indices = NDArray[np.int64]

#: Above this many points a path is thinned evenly first, so that memory stays bounded too.
_DENSE = 600_000


def bucket_times(time: Floats, limit: int) -> Floats:
    """Return the instants (at most ``limit``) that belong to the values of :func:`bucket_extremes`."""
    size = _bucket_size(time.shape[0], limit)
    if size == 1:
        return time
    first = np.arange(0, time.shape[0], size)
    last = np.minimum(first + size, time.shape[0]) - 1
    span = time[last] - time[first]
    return np.stack((time[first] + 0.25 * span, time[first] + 0.75 * span), axis=1).ravel()


def bucket_extremes(values: Floats, limit: int) -> Floats:
    """Return at most ``limit`` values: least and greatest of equal buckets, in the order they occurred.

    A column that is short enough comes back whole.  No peak is ever lost: the extremes of the result are those of
    ``values``.
    """
    size = _bucket_size(values.shape[0], limit)
    if size == 1:
        return values
    padded = np.pad(values, (0, -values.shape[0] % size), mode="edge").reshape(-1, size)
    where = np.stack((padded.argmin(axis=1), padded.argmax(axis=1)), axis=1)
    where.sort(axis=1)
    return np.take_along_axis(padded, where, axis=1).ravel()


def _bucket_size(count: int, limit: int) -> int:
    return 1 if count <= limit else -(-count // (limit // 2))


def simplify(parameter: Floats, features: Floats, limit: int) -> Indices:
    """Return the rising indices of at most ``limit`` points that tell the path best; ends and extremes stay.

    A point is worth the distance between it and where its neighbours, joined linearly in ``parameter`` (n,), put it,
    measured in ``features`` (n, d) that the caller has scaled.  With time as parameter this is the *synchronous*
    distance: the shorter path is in the right place at the right time (Meratnia and de By, 2004).  A pass drops the
    less worthy half, but only every other point, so that no pass takes two neighbours.
    """
    anchored = _anchored(features)
    chosen = anchored.copy()
    chosen[:: -(-parameter.shape[0] // _DENSE) or 1] = True
    kept = np.flatnonzero(chosen)
    goal = max(limit, int(np.count_nonzero(anchored)))
    parity = 0
    while kept.size > goal:
        inner = np.flatnonzero(~anchored[kept])
        worth = _worth(parameter, features, kept, inner)
        flat = worth <= np.partition(worth, (inner.size - 1) // 2)[(inner.size - 1) // 2]
        turn = flat & (inner % 2 == parity)
        drop, surplus = inner[turn], kept.size - goal
        if drop.size > surplus:
            drop = drop[np.argpartition(worth[turn], surplus - 1)[:surplus]]
        kept = np.delete(kept, drop)
        parity ^= 1
    return kept


def _anchored(features: Floats) -> NDArray[np.bool_]:
    """Return whether each point is one of both ends or an extreme of a feature."""
    anchored = np.zeros(features.shape[0], np.bool_)
    if features.shape[0]:
        anchored[[0, -1]] = True
        anchored[features.argmin(axis=0)] = True
        anchored[features.argmax(axis=0)] = True
    return anchored


def _worth(parameter: Floats, features: Floats, kept: Indices, candidates: Indices) -> Floats:
    """Return how far each candidate (a place in ``kept``) lies from the chord of its neighbours."""
    before, here, after = kept[candidates - 1], kept[candidates], kept[candidates + 1]
    span = parameter[after] - parameter[before]
    weight = np.divide(parameter[here] - parameter[before], span, out=np.full(span.shape, 0.5), where=span > 0)
    chord = features[before] + weight[:, None] * (features[after] - features[before])
    return np.linalg.norm(features[here] - chord, axis=1)
