"""How far a commanded path lies from the programmed one, both ways.  Out: the greatest part of P that is used.

Points of either path (ends, quarters and middles of every segment, so also every corner) are projected on the other:
on the nearest of its sampled points, and from there by Newton's steps on the curve itself.  So a distance is that of
the curves, not of chords, or else more than it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.distance import cdist

from trochia.program import PathMode

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.program import Program
    from trochia.toolpath import Toolpath

_EACH, _FINE = 4, 6  #: parts of a segment whose ends are looked at; of its half, that the nearest is looked for in
_NEAR, _OWN = 4, 14  #: nearest halves on which Newton's steps begin, of all and of those of near moves
_ROUNDING = 2e-12  #: mm: what places far from zero are known to


def used(program: Program, machine: Machine, commanded: Toolpath, programmed: Toolpath) -> float:
    """Return the greatest distance between two paths over what is allowed there; 0 where both are the same."""
    if not len(commanded) or not len(programmed):
        return 0.0
    tolerances = np.where(program.moves["path_mode"] == PathMode.BLEND, program.moves["tolerance"][:, 0], 0.0)
    tolerances[program.moves["path_mode"] == PathMode.BLEND_DEFAULT] = machine.path_tolerance
    order = np.unique(programmed.segments["move"])
    around = np.concatenate([[0.0], tolerances[order], [0.0]])
    allowed = np.maximum(np.maximum(around[:-2], around[1:-1]), around[2:])
    most = 0.0
    linear = sum(axis in "XYZ" for axis in commanded.axes)
    for group in (slice(0, linear), slice(linear, None)):
        moved = programmed.points(*_samples(programmed, 1))[:, group]
        if not moved.size or np.ptp(moved) == 0.0:
            continue
        for one, other in ((commanded, programmed), (programmed, commanded)):
            rows, s = _samples(one, _EACH)
            permitted = allowed[np.searchsorted(order, one.segments["move"][rows]).clip(0, len(order) - 1)]
            distance = np.maximum(
                _distance(one.points(rows, s), one.segments["move"][rows], other, group) - _ROUNDING, 0.0
            )
            off = distance > 0.0
            with np.errstate(divide="ignore"):
                most = max(most, float((distance[off] / permitted[off]).max(initial=0.0)))
    return most


def _samples(path: Toolpath, each: int) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    rows = np.repeat(np.arange(len(path)), each + 1)
    return rows, np.tile(np.linspace(0.0, 1.0, each + 1), len(path)) * path.segments["length"][rows]


def _distance(
    points: NDArray[np.float64], moves: NDArray[np.uint32], path: Toolpath, group: slice
) -> NDArray[np.float64]:
    """Return the distance of points (k, n) of some moves (k,) to a path, in the columns of a group (k,)."""
    cells = np.repeat(np.arange(len(path)), 2)  # halves of segments, as a circle's end is its start
    inside = np.tile(np.linspace([0.0, 0.5], [0.5, 1.0], _FINE + 1, axis=1), (len(path), 1))
    inside *= path.segments["length"][cells][:, None]
    samples = path.points(np.repeat(cells, _FINE + 1), inside.ravel())[:, group]
    points = points[:, group]
    apart = cdist(points, samples).reshape(len(points), len(cells), _FINE + 1)
    least, few, many = apart.min(axis=2), min(_NEAR, len(cells)), min(_OWN, len(cells))
    order = np.unique(path.segments["move"])  # one of them stands for those behind it that it was merged with
    number = np.searchsorted(order, moves, side="right") - 1
    own = np.abs(np.searchsorted(order, path.segments["move"])[cells] - number[:, None]) <= 1
    cell = np.concatenate([np.argpartition(off, count - 1, axis=1)[:, :count]
                           for off, count in ((least, few), (np.where(own, least, np.inf), many))], axis=1)  # fmt: skip
    at = inside[cell, np.take_along_axis(apart.argmin(axis=2), cell, axis=1)].ravel()
    row, goal = cells[cell.ravel()], np.repeat(points, few + many, axis=0)
    best = np.full(len(goal), np.inf)
    for step in range(7):
        off, slope, bend = (path.points(row, at, derivative)[:, group] for derivative in range(3))
        off -= goal
        best = np.minimum(best, np.linalg.norm(off, axis=1))
        curve = (slope * slope).sum(axis=1) + (off * bend).sum(axis=1)
        change = (off * slope).sum(axis=1) / np.where(curve > 0.0, curve, np.inf)
        at = np.clip(at - change, 0.0, path.segments["length"][row]) if step < 6 else at
    return best.reshape(len(points), -1).min(axis=1)
