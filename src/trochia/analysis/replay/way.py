"""How far apart two ways are, whenever they were gone.  In: two recordings.  Out: a distance at every sample.

A hold, an override or a slower feed shift times and leave the way: this asks where, not when.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder import Recording

NEAR = 1e-9  #: samples of a way nearer than this to the one before are one place [mm]
CLOSEST = 3  #: places looked at around each point: the nearest place need not be an end of the nearest chord


def way_apart(plan: Recording, run: Recording, quantity: str = "commanded") -> NDArray[np.float64]:
    """Return how far each sample of a run is from a plan's commanded way, chords of its samples (samples,) [mm].

    Parameters
    ----------
    quantity
        Of the run's axes: ``commanded`` or ``actual``.
    """
    from scipy.spatial import KDTree  # noqa: PLC0415 - heavy, asked for only

    axes = [axis for axis in plan.axes if axis in "XYZ" and f"{axis}.{quantity}" in run]
    way = np.stack([plan[f"{axis}.commanded"] for axis in axes], axis=1)
    fresh = np.concatenate([[True], np.linalg.norm(np.diff(way, axis=0), axis=1) > NEAR])
    way = way[fresh]
    points = np.stack([run[f"{axis}.{quantity}"] for axis in axes], axis=1)
    if len(way) == 1:
        return np.linalg.norm(points - way[0], axis=1)
    nearest = np.asarray(KDTree(way).query(points, k=min(CLOSEST, len(way)))[1], np.intp)
    apart = np.full(len(points), np.inf)
    for column in nearest.T:
        for begin in (np.maximum(column - 1, 0), np.minimum(column, len(way) - 2)):
            apart = np.minimum(apart, _from_chord(points, way[begin], way[begin + 1]))
    return apart


def _from_chord(
    points: NDArray[np.float64], begin: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distance of points from chords (points,)."""
    chord = end - begin
    length = np.einsum("ij,ij->i", chord, chord)
    share = np.clip(np.einsum("ij,ij->i", points - begin, chord) / np.maximum(length, 1e-300), 0.0, 1.0)
    return np.linalg.norm(points - begin - share[:, None] * chord, axis=1)
