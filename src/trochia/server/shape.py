"""The loaded program's path, for looking at.  In: its plan.  Out: a binary frame of points with source lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.report.decimate import simplify
from trochia.messages import pack
from trochia.toolpath.toolpath import SegmentKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan
    from trochia.toolpath import Toolpath

TOLERANCE = 0.01  #: between a curve and its chords [mm]
MOST_CHORDS = 256  #: of one segment
DENSEST = 4_000_000  #: points looked at before they are thinned


def path_frame(plan: Plan, name: str, points: int) -> bytes:
    """Return the frame of a plan's path as commanded, in at most about so many points.

    Columns: ``points`` (rows, axes) [mm, degree] in machine coordinates, ``lines`` (rows,), ``rapid`` (rows,) 0 or 1;
    a row is where a stretch ends, the first is where the path begins.
    """
    path = plan.path
    rows, s = _stations(path)
    places = np.concatenate([path.start[None, :], path.points(rows, s)]) if len(rows) else path.start[None, :]
    lines = np.concatenate([[0], plan.program.moves["line"][path.segments["move"][rows]]]) if len(rows) else np.zeros(1)
    rapid = np.concatenate([[True], ~path.is_feed[rows]]) if len(rows) else np.ones(1, bool)
    if len(places) > points:
        kept = simplify(np.arange(len(places), dtype=np.float64), places, points)
        places, lines, rapid = places[kept], lines[kept], rapid[kept]
    columns: dict[str, NDArray[Any]] = {
        "points": places.astype(np.float32), "lines": lines.astype(np.uint32), "rapid": rapid.astype(np.uint8),
    }  # fmt: skip
    return pack("path", columns, name=name, axes=path.axes)


def _stations(path: Toolpath) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return segment and s of the end of every chord (rows,), (rows,)."""
    if not len(path):
        return np.zeros(0, np.intp), np.zeros(0)
    counts = _chords(path)
    counts = np.minimum(counts, max(DENSEST // len(path), 1))
    rows = np.repeat(np.arange(len(path)), counts)
    within = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
    return rows, path.segments["length"][rows] * within / counts[rows]


def _chords(path: Toolpath) -> NDArray[np.intp]:
    """Return how many chords each segment needs: with curvature k, a chord of sqrt(8 TOLERANCE / k) is off by that."""
    counts = np.ones(len(path), np.intp)
    curved = np.flatnonzero(path.segments["kind"] != SegmentKind.LINE)
    if len(curved):
        length = path.segments["length"][curved]
        bend = np.max([np.linalg.norm(path.points(curved, length * part, 2), axis=1) for part in (0.0, 0.5, 1.0)], 0)
        wanted = np.ceil(length * np.sqrt(bend / (8.0 * TOLERANCE)))
        counts[curved] = np.clip(np.nan_to_num(wanted), 1, MOST_CHORDS).astype(np.intp)
    return counts
