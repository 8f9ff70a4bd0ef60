"""Backing up, so that motion passes a place again at speed.  In: a road, a place.  Out: where from, and the way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import MOVE
from trochia.planner.live.change import Ahead
from trochia.planner.live.pieces import reversed_path
from trochia.planner.live.road import Place, Road, Stretch
from trochia.planner.live.window import plan_window

if TYPE_CHECKING:
    from trochia.planner.live.lookahead import Lookahead
    from trochia.planner.live.window import Speeds

_LONGER = 1.5  #: a run-up that is too short is tried so much longer
_AT_SPEED = 1.0 - 1e-9
_MOST = 2.5  #: of v times the worst stopping time: the longest run-up


def run_up(ahead: Lookahead, t: float, speeds: Speeds) -> Place:
    """Return where to begin at rest so that the place of ``t`` is passed as fast as ``t`` it was.

    At the latest that is where motion last rested before, as far as that is in hand; or where it comes nearest to that
    speed, of run-ups that are not longer than any can need.
    """
    out = ahead.state(t)
    # a plan of long curves differs a little with where it begins: the very speed may come from far behind only
    place, v = Place(int(out["segment"]), float(out["s"])), float(out["v"])
    earliest = ahead.rested_before(t)
    end = ahead.window_from(place.row)
    best, fastest = earliest, -1.0
    way = 0.5 * v * ahead.rules.stopping_time
    while True:
        start = behind(ahead.road, place, way)
        if start <= earliest:
            return earliest
        phases = plan_window(ahead.road, ahead.rules, start, end, speeds)
        view = Ahead(ahead.road, phases, place)
        passed = float(view.state(view.begin)["v"])
        if passed >= v * _AT_SPEED:
            return start
        if passed > fastest:
            best, fastest = start, passed
        way *= _LONGER
        if way > _MOST * v * ahead.rules.stopping_time:
            return best


def behind(road: Road, place: Place, way: float) -> Place:
    """Return the place some way before another, at the earliest where the road in hand begins."""
    row, s = place.row, place.s - way
    while s < 0.0 and row > road.base:
        row -= 1
        s += float(road.segments["length"][row - road.base])
    return Place(row, max(s, 0.0))


def way_back(road: Road, start: Place, end: Place) -> Road | None:
    """Return the road from a place back to an earlier one, its beam dark; None where they are the same."""
    base = road.base
    rows, pool = reversed_path(road.segments, road.pool, len(road.axes), (start.row - base, start.s),
                               (end.row - base, end.s))  # fmt: skip
    if not len(rows):
        return None
    first = start.row - base - (0 if start.s > 0.0 else 1)
    low = int(rows["move"].min())
    rows["move"] -= np.uint32(low)
    moves = np.zeros(int(rows["move"].max()) + 1, dtype=MOVE)
    moves["line"][rows["move"]] = road.lines(base + first - len(rows) + 1, base + first + 1)[::-1]
    none = np.zeros(0)
    back = Road(road.axes, iter([Stretch(segments=rows, pool=pool, moves=moves, first_move=low,
                                         rests=none.astype(np.uint64), seconds=none, start=pool[:0])]))  # fmt: skip
    back.more()
    back.more()
    return back


def forward_of(start: Place, back: Road, place: Place, end: Place) -> Place:
    """Return where a place on the way back from ``start`` to ``end`` lies on the road itself."""
    if place.row >= back.end:
        return end
    first = start.row - (0 if start.s > 0.0 else 1)
    row = first - place.row
    from_s = end.s if row == end.row else 0.0
    return Place(row, from_s + float(back.segments["length"][place.row]) - place.s)
