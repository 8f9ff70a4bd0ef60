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
_DENSE = 2_000_000


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
    distance: the shorter path is in the right place at the right time (Meratnia and de By, 2004).  Passes drop the
    least worthy of every other point, so that no pass takes two neighbours.
    """
    kept = np.arange(0, parameter.shape[0], -(-parameter.shape[0] // _DENSE) or 1)
    anchors = _anchors(features)
    kept = np.union1d(kept, anchors)
    parity = 0
    while kept.size > max(limit, anchors.size):
        candidates = np.arange(1 + parity, kept.size - 1, 2)
        candidates = candidates[~np.isin(kept[candidates], anchors, assume_unique=True)]
        parity ^= 1
        if candidates.size:
            share = min(kept.size - max(limit, anchors.size), max(1, candidates.size // 2))
            worth = _worth(parameter, features, kept, candidates)
            kept = np.delete(kept, candidates[np.argpartition(worth, share - 1)[:share]])
    return kept


def _anchors(features: Floats) -> Indices:
    """Return both ends and the extremes of every feature."""
    if not features.shape[0]:
        return np.zeros(0, np.int64)
    ends = np.array((0, features.shape[0] - 1))
    return np.unique(np.concatenate((ends, features.argmin(axis=0), features.argmax(axis=0))))


def _worth(parameter: Floats, features: Floats, kept: Indices, candidates: Indices) -> Floats:
    """Return how far each candidate (a place in ``kept``) lies from the chord of its neighbours."""
    before, here, after = kept[candidates - 1], kept[candidates], kept[candidates + 1]
    span = parameter[after] - parameter[before]
    weight = np.divide(parameter[here] - parameter[before], span, out=np.full(span.shape, 0.5), where=span > 0)
    chord = features[before] + weight[:, None] * (features[after] - features[before])
    return np.linalg.norm(features[here] - chord, axis=1)
