"""Ramps laid on a road.  In: where they begin, pieces of constant jerk.  Out: phases, cut where segments meet.

And whether these keep every limit: at 25 instants of each phase and, where three of them come near a limit, at the top
of the parabola through them.  (On lines and cubics what is looked at is a polynomial of degree seven in time at most.)
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.layout import PHASE
from trochia.planner.live.portion import moved_on

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.planner.live.road import Place, Road
    from trochia.planner.live.window import Rules
    from trochia.planner.ramp import Piece

_INTERVALS = 24
_KEPT = 1.0 + 1e-10  #: of a limit
_SAME = 1e-5  #: of a limit: what may jump where segments meet, as directions within 1e-6 rad count as the same
_NOTHING = 1e-12  #: of a speed


def lay(road: Road, start: Place, pieces: Sequence[Piece], t: float) -> NDArray[Any] | None:
    """Return the phases of pieces from a place on, begun at ``t``; None where they run past the road in hand."""
    way = np.cumsum([0.0, *(piece.way for piece in pieces)])
    first = start.row - road.base
    joints = _joints(road, first, start.s, float(way[-1]))
    if joints is None:
        return None
    rows: list[tuple[float, ...]] = []
    crossed = 0
    for k, piece in enumerate(pieces):
        tau = 0.0
        while tau < piece.duration:
            here, until = first + crossed, piece.duration
            crosses = crossed < len(joints) and joints[crossed] < way[k + 1]
            if crosses:
                until = _when(piece, float(joints[crossed] - way[k]), tau)
            if until > tau:
                begin = float(joints[crossed - 1]) if crossed else -start.s
                v, a = piece._replace(duration=tau).end
                s = way[k] + piece._replace(duration=tau).way - begin
                rows.append((t + tau, until - tau, max(s, 0.0), v, a, piece.j, here + road.base, 0))
            crossed += crosses
            tau = until
        t += piece.duration
    return np.array(rows, dtype=PHASE)


def _joints(road: Road, first: int, s: float, way: float) -> NDArray[np.float64] | None:
    """Return how far the joints within some way lie ahead (k,); None where the road in hand ends before."""
    count = 64
    while True:
        joints = np.cumsum(road.segments["length"][first : first + count]) - s
        if len(joints) and joints[-1] >= way:
            return joints[: int(np.searchsorted(joints, way))]
        if first + count >= len(road.segments):
            return joints[:-1] if len(joints) and joints[-1] >= way - 1e-9 else None
        count *= 4


def _when(piece: Piece, way: float, low: float) -> float:
    """Return when a piece has gone some way, not before ``low``: Newton's steps, kept in by halving."""
    high, tau = piece.duration, min(low + max(way, 0.0) / max(piece.v, 1e-9), piece.duration)
    for _ in range(60):
        here = piece._replace(duration=tau)
        off, v = here.way - way, here.end[0]
        low, high = (low, tau) if off > 0.0 else (tau, high)
        after = tau - off / v if v > 0.0 else -1.0
        after = after if low <= after <= high else 0.5 * (low + high)
        if abs(after - tau) <= 1e-15 * (1.0 + high):
            return after
        tau = after
    return tau


def keeps(road: Road, rules: Rules, phases: NDArray[Any], feed: float) -> bool:
    """Return whether phases keep every limit, and ``feed`` times the programmed one, where they may not stop before.

    They must also pass no joint at which motion stops, or at which velocity (and with limited jerk acceleration) jumps.
    """
    if not len(phases):
        return True
    rows = phases["segment"].astype(np.int64) - road.base
    passed = rows[:-1][rows[1:] != rows[:-1]]
    states = np.repeat(phases, _INTERVALS + 1)
    tau = np.tile(np.linspace(0.0, 1.0, _INTERVALS + 1), len(phases)) * states["duration"]
    speeds = states["v"] + tau * (states["a"] + tau * states["j"] / 2)
    if road.segments["stop"][passed].any() or speeds.min() < -_NOTHING * max(1.0, float(speeds.max())):
        return False
    states = moved_on(states, tau, states["t"])
    states["segment"] -= np.uint32(road.base)
    most = road.segments["speed_limit"][states["segment"]] * feed
    if (states["v"] > most * _KEPT + _NOTHING).any():
        return False
    orders = (1, 2, 3) if rules.jerk_limited else (1, 2)
    return all(_kept(road, rules, states, order) for order in orders)


def _kept(road: Road, rules: Rules, states: NDArray[Any], order: int) -> bool:
    """Return whether velocities (order 1), accelerations (2) or jerks (3) stay inside all limits, and do not jump."""
    limits, linear = rules.limits, rules.limits.linear
    value = kernel.sample(road.segments, road.pool, len(road.axes), states, order)
    asked = np.abs(value @ limits.matrix.T)
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    bounds = (limits.velocity, limits.acceleration, limits.jerk)[order - 1]
    if order == 2 and limits.curves and getattr(rules.profile, "by_curves", False):
        speed = kernel.sample(road.segments, road.pool, len(road.axes), states, 1) @ limits.matrix.T
        bounds = limits.acceleration_at(np.abs(speed))
    used = asked / bounds
    if math.isfinite(caps[order - 1]):
        vector = np.linalg.norm(value[:, :linear], axis=1) / caps[order - 1]
        used = np.concatenate([used, vector[:, None]], axis=1)
    if used.max() > _KEPT or _top(used.reshape(-1, _INTERVALS + 1, used.shape[1])) > _KEPT:
        return False
    if order == 3 or (order == 2 and not rules.jerk_limited):
        return True
    ends = value.reshape(-1, _INTERVALS + 1, value.shape[1])
    scale = (limits.velocity, limits.acceleration)[order - 1][: value.shape[1]]
    return bool((np.abs(ends[1:, 0] - ends[:-1, -1]) <= _SAME * scale).all())


def _top(used: NDArray[np.float64]) -> float:
    """Return the highest top of the parabolas through three neighbours each, (phases, instants, rows)."""
    left, here, right = used[:, :-2], used[:, 1:-1], used[:, 2:]
    tops = (here >= left) & (here >= right) & (here > 0.98)
    if not tops.any():
        return 0.0
    left, here, right = left[tops], here[tops], right[tops]
    bend = 2.0 * here - left - right
    rise = (right - left) ** 2 / np.where(bend > 0.0, 8.0 * bend, np.inf)
    return float((here + rise).max())
