"""The parallel of a contour: what the tool's edge follows at a distance from the part.

In: segments one after another, and a distance to their left (negative: right).  Out: the same at that distance, round
the corners that point to that side by arcs, shortened in the others.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot
from typing import TYPE_CHECKING

from trochia.geometry.segments import NEAR, Segment, cross, lines_meet, meetings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.geometry.segments import Vector

_MOST_LOST = 40  # segments that may vanish in one corner
_MOST_GONE = 6.0  # distances that they may be long in all
_SLACK = 1e-6  # of the distance
_TOO_NARROW = "a corner of it is too narrow for that distance"


def parallel(contour: Sequence[Segment], distance: float, *, least: float = 0.0) -> list[Segment]:
    """Return the contour at a distance to its left; an arc round a corner is at least so long along the first axis.

    Raises
    ------
    ValueError
        Where the contour has a corner too narrow for it.
    """
    if distance == 0.0:
        return list(contour)
    moved = _moved(contour, distance, least)
    made = moved[:1]
    at = 1
    while at < len(moved):
        joined = _join(made, moved, at, _MOST_GONE * abs(distance))
        if joined is None:
            raise ValueError(_TOO_NARROW)
        if len(joined[0]) == 1:
            joined = [_begun(joined[0][0], moved[0])], joined[1]
        made, at = joined
    made = [segment for segment in made if not segment.is_point]
    if _too_near(made, contour, abs(distance)):
        raise ValueError(_TOO_NARROW)
    return made


def _begun(segment: Segment, first: Segment) -> Segment:
    """Return what is left of a segment where all before it has vanished: from where it meets the first one, led on."""
    held = [point for point in lines_meet(first, segment) if segment.holds(point)]
    return replace(segment, start=min(held, key=segment.way_to)) if held else segment


def _too_near(made: Sequence[Segment], contour: Sequence[Segment], distance: float) -> bool:
    """Return whether a joint lies nearer to the contour than the distance, as where a contour crosses itself."""
    for point in [*(segment.start for segment in made), *(segment.end for segment in made[-1:])]:
        for one in contour:
            low, high = sorted((one.start[0], one.end[0]))
            if low - distance < point[0] < high + distance and one.distance(point) < distance * (1.0 - _SLACK):
                return True
    return False


def _moved(contour: Sequence[Segment], distance: float, least: float) -> list[Segment]:
    """Return each segment's parallel, joined in corners that point to its side."""
    moved: list[Segment] = []
    for index, segment in enumerate(contour):
        aside = segment.parallel(distance)
        if aside is None:
            continue
        corner = _corner(contour[index - 1], segment, distance) if index else None
        if corner is not None and moved:
            if abs(corner.end[0] - corner.start[0]) > least:
                moved.append(corner)
            else:
                moved[-1], aside = _mitred(moved[-1], aside)
        moved.append(aside)
    return moved


def _corner(segment: Segment, after: Segment, distance: float) -> Segment | None:
    """Return the arc round the corner between two segments; None where it points to the other side."""
    before, behind = segment.tangent(segment.end), after.tangent(after.start)
    bend = cross(before, behind)
    if abs(bend) <= NEAR and before[0] * behind[0] + before[1] * behind[1] < 0.0:
        bend = -distance  # it turns back on itself: round its tip
    if bend * distance >= -NEAR * abs(distance):
        return None
    corner = segment.end
    return Segment(start=_aside(corner, before, distance), end=_aside(corner, behind, distance), centre=corner,
                   sense=1 if bend > 0 else -1)  # fmt: skip


def _mitred(one: Segment, other: Segment) -> tuple[Segment, Segment]:
    """Return two segments led on to where they meet."""
    gap = hypot(one.end[0] - other.start[0], one.end[1] - other.start[1])
    for point in lines_meet(one, other):
        if hypot(point[0] - one.end[0], point[1] - one.end[1]) <= 2 * gap:
            return replace(one, end=point), replace(other, start=point)
    return one, replace(other, start=one.end)


def _join(made: list[Segment], moved: list[Segment], at: int, most: float) -> tuple[list[Segment], int] | None:
    """Return the contour with the next segment that meets it, fewest others lost, and what comes after that.

    What is lost is no longer than ``most`` in all: more than that is no corner that a tool does not reach.
    """
    for lost in range(_MOST_LOST):
        for skipped in range(lost + 1):
            back, ahead = len(made) - 1 - (lost - skipped), at + skipped
            if back < 0 or ahead >= len(moved) or _length([*made[back + 1 :], *moved[at:ahead]]) > most:
                continue
            met = _meet(made[back], moved[ahead])
            if met is not None:
                return [*made[:back], *met], ahead + 1
    return ([moved[at]], at + 1) if _length(made) <= most else None  # all before it has vanished


def _length(segments: Sequence[Segment]) -> float:
    return sum(hypot(one.end[0] - one.start[0], one.end[1] - one.start[1]) for one in segments)


def _meet(one: Segment, other: Segment) -> tuple[Segment, ...] | None:
    """Return two segments cut where the first one meets the other first; None: nowhere."""
    if hypot(one.end[0] - other.start[0], one.end[1] - other.start[1]) <= NEAR:
        return one, other
    points = meetings(one, other)
    if not points:
        return None
    point = min(points, key=one.way_to)
    return replace(one, end=point), replace(other, start=point)


def _aside(point: Vector, tangent: Vector, distance: float) -> Vector:
    return point[0] - tangent[1] * distance, point[1] + tangent[0] * distance
