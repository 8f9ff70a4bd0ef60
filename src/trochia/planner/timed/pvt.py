"""PVT: each move is given by its end, the velocity there, and its time.  In: those.  Out: the cubics through them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.planner.timed.pieces import hermite

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from trochia.planner.timed.pieces import Pieces


def pvt(start: ArrayLike, ends: ArrayLike, velocities: ArrayLike, times: ArrayLike) -> Pieces:
    """Return the motion from rest at ``start`` (n,) through each end (m, n) with its velocity (m, n) in its time (m,).

    Velocity is a parabola in each move: nothing but its end and time decides it, whatever the axes can do.

    Raises
    ------
    LimitError
        When a time is not above 0, or the last move does not end at rest.
    """
    points = np.vstack([np.atleast_1d(np.asarray(start, np.float64)), np.asarray(ends, np.float64)])
    rates = np.vstack([np.zeros(points.shape[1]), np.asarray(velocities, np.float64)])
    spans = np.asarray(times, dtype=np.float64)
    if not (spans > 0.0).all():
        raise LimitError("a PVT move takes a time above zero", hint="Give PVT and its time before the move.")
    if rates[-1].any():
        raise LimitError("a series of PVT moves ends at rest", hint="Give the last move the velocity 0, like X10:0.")
    return hermite(points, rates, spans, np.arange(len(spans)))
