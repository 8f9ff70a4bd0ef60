"""Fillets and chamfers in the corners of a contour.

In: two segments that meet, and the radius of the arc that touches both.  Out: the segments shortened, and the arc or
the straight line between the points where it touches.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot

from trochia.geometry.segments import NEAR, Segment, Vector, cross, lines_meet

LEAST = 1e-3  #: between the points where the arc would touch; below, the corner stays, as in the reference


def rounded(before: Segment, after: Segment, radius: float, *, straight: bool) -> tuple[Segment, Segment, Segment]:
    """Return the two segments with what rounds their corner between them.

    The centre lies at the radius from both, on the side to which the contour turns.

    Raises
    ------
    ValueError
        Where no arc of that radius touches both.
    """
    bend = cross(before.tangent(before.end), after.tangent(after.start))
    if abs(bend) <= NEAR:
        return before, Segment(start=before.end, end=before.end), after
    side = 1 if bend > 0 else -1
    one, other = before.parallel(side * radius), after.parallel(side * radius)
    centres = [] if one is None or other is None else lines_meet(one, other)
    for centre in sorted(centres, key=lambda centre: hypot(centre[0] - before.end[0], centre[1] - before.end[1])):
        first, second = _foot(before, centre), _foot(after, centre)
        if before.holds(first) and after.holds(second):
            if hypot(second[0] - first[0], second[1] - first[1]) <= LEAST:
                return before, Segment(start=before.end, end=before.end), after
            between = Segment(start=first, end=second)
            if not straight:
                between = replace(between, centre=centre, sense=side)
            return replace(before, end=first), between, replace(after, start=second)
    raise ValueError("no arc of that radius touches both")


def _foot(segment: Segment, centre: Vector) -> Vector:
    """Return the point of the segment's line or circle nearest to a point."""
    if segment.centre is None:
        across, up = segment.tangent(segment.start)
        along = (centre[0] - segment.start[0]) * across + (centre[1] - segment.start[1]) * up
        return segment.start[0] + along * across, segment.start[1] + along * up
    away = centre[0] - segment.centre[0], centre[1] - segment.centre[1]
    share = segment.radius / hypot(*away)
    return segment.centre[0] + share * away[0], segment.centre[1] + share * away[1]
