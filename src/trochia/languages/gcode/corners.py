"""Where the tool's centre turns at a corner of the programmed path: plane geometry of cutter compensation.

In: the corner, the unit normals of the two paths there (towards the tool), and the paths of the tool's centre, which
run parallel to the programmed ones at the tool's radius.  Out: the point where those two meet.

Legend: ``corner`` programmed point; ``before``, ``after`` unit normals at the corner; ``side`` +1 tool on the left of
the path, -1 on the right; ``radius`` of the tool.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, atan2, cos, hypot, pi, sin, sqrt, tau

Vector = tuple[float, float]

NEARLY_STRAIGHT = 0.05  #: a corner of a smaller angle counts as smooth [rad]


@dataclass(slots=True)
class Circle:
    """Path of the tool's centre along an arc.

    ``sense`` is +1 counter-clockwise, -1 clockwise; ``inside`` says that the tool is on the centre's side of the arc.
    """

    centre: Vector
    radius: float
    sense: int
    inside: bool


def normal_of(across: float, up: float, side: int) -> Vector:
    """Return the unit normal towards the tool of a line with that direction, which is not zero."""
    length = hypot(across, up)
    return -side * up / length, side * across / length


def bend(before: Vector, after: Vector, side: int) -> float:
    """Return by how much the path turns away from the tool, -pi to pi [rad]; negative: towards it."""
    cross = before[0] * after[1] - before[1] * after[0]
    return -side * atan2(cross, before[0] * after[0] + before[1] * after[1])


def opens(angle: float) -> bool:
    """Return whether the tool goes around a corner outside, by an arc."""
    return angle > NEARLY_STRAIGHT or angle < NEARLY_STRAIGHT - pi


def turns_back(angle: float) -> bool:
    """Return whether the path leads back the way it came."""
    return abs(angle) > pi - NEARLY_STRAIGHT


def closes(angle: float) -> bool:
    """Return whether the tool must stop short of a corner."""
    return NEARLY_STRAIGHT - pi <= angle < -NEARLY_STRAIGHT


def line_to_line(corner: Vector, before: Vector, after: Vector, radius: float) -> Vector | None:
    """Return where two lines at the tool's radius meet, on the bisector of the corner; None where they never do."""
    share = 1.0 + before[0] * after[0] + before[1] * after[1]
    if share == 0.0:
        return None
    reach = radius / share
    return corner[0] + reach * (before[0] + after[0]), corner[1] + reach * (before[1] + after[1])


def line_to_circle(point: Vector, direction: Vector, circle: Circle, *, ahead: bool) -> Vector | None:
    """Return where a line through a point cuts a circle, the farther cut along the line or the nearer; None: nowhere.

    A line at distance h from the centre cuts at sqrt(R^2 - h^2) to both sides of the centre's foot on it.
    """
    across, up = circle.centre[0] - point[0], circle.centre[1] - point[1]
    along = across * direction[0] + up * direction[1]
    aside = across * direction[1] - up * direction[0]
    rest = circle.radius * circle.radius - aside * aside
    if rest < 0.0:
        return None
    along += sqrt(rest) if ahead else -sqrt(rest)
    return point[0] + along * direction[0], point[1] + along * direction[1]


def on_programmed_arc(corner: Vector, circle: Circle, radius: float) -> Vector:
    """Return the point of the arc that the tool follows on a circle, in the direction of the corner."""
    across, up = corner[0] - circle.centre[0], corner[1] - circle.centre[1]
    share = (circle.radius + (radius if circle.inside else -radius)) / hypot(across, up)
    return circle.centre[0] + share * across, circle.centre[1] + share * up


def circle_to_circle(old: Circle, new: Circle) -> Vector | None:
    """Return where the centre's path leaves one circle for another; None where they do not cut.

    Seen from the old centre the new circle spans the cosine rule's angle to both sides of the centre line.  A tool
    that must stay inside the new circle meets it where it would leave, one outside where it would enter.
    """
    across, up = new.centre[0] - old.centre[0], new.centre[1] - old.centre[1]
    apart = hypot(across, up)
    if apart == 0.0 or old.radius == 0.0:
        return None
    cosine = (old.radius * old.radius + apart * apart - new.radius * new.radius) / (2 * old.radius * apart)
    if abs(cosine) > 1.0:
        return None
    angle = atan2(up, across) + old.sense * acos(cosine) * (1 if new.inside else -1)
    return old.centre[0] + old.radius * cos(angle), old.centre[1] + old.radius * sin(angle)


def swept(start: Vector, end: Vector, centre: Vector, sense: int) -> float:
    """Return the angle of an arc from start to end about a centre, 0 to one turn [rad]."""
    begin = atan2(start[1] - centre[1], start[0] - centre[0])
    return sense * (atan2(end[1] - centre[1], end[0] - centre[0]) - begin) % tau


def entry_centre(start: Vector, end: Vector, normal: Vector) -> Vector | None:
    """Return the centre, on the normal through ``end``, of the arc from ``start``; None where they lie on a tangent.

    k with |start - (end + k n)| = |k|, so k = |w|^2 / 2 w.n, w = start - end.
    """
    across, up = start[0] - end[0], start[1] - end[1]
    share = 2 * (across * normal[0] + up * normal[1])
    if share == 0.0:
        return None
    reach = (across * across + up * up) / share
    return end[0] + reach * normal[0], end[1] + reach * normal[1]
