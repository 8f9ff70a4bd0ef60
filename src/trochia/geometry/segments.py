"""Lines and arcs in the plane, one after another: a contour.

In: ends, and centre and sense of an arc.  Out: lengths, tangents, parallels, and where two of them meet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, hypot, sqrt, tau

Vector = tuple[float, float]

NEAR = 1e-9  #: lengths below this are none


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """A line, or an arc of less than a whole turn.

    Attributes
    ----------
    start, end
        Its ends.
    centre
        Of the arc; None: a line.
    sense
        +1 counter-clockwise, -1 clockwise, 0 a line.
    """

    start: Vector
    end: Vector
    centre: Vector | None = None
    sense: int = 0

    @property
    def radius(self) -> float:
        """Return the radius; 0 of a line."""
        return 0.0 if self.centre is None else hypot(self.start[0] - self.centre[0], self.start[1] - self.centre[1])

    @property
    def is_point(self) -> bool:
        """Return whether it leads nowhere."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]) <= NEAR

    def tangent(self, point: Vector) -> Vector:
        """Return its direction at one of its points, of length 1."""
        if self.centre is None:
            across, up = self.end[0] - self.start[0], self.end[1] - self.start[1]
        else:
            across, up = self.sense * (self.centre[1] - point[1]), self.sense * (point[0] - self.centre[0])
        size = hypot(across, up) or 1.0
        return across / size, up / size

    def turned(self, point: Vector) -> float:
        """Return the angle of the arc from its start to a point, 0 to one turn [rad]."""
        assert self.centre is not None
        begin = atan2(self.start[1] - self.centre[1], self.start[0] - self.centre[0])
        return self.sense * (atan2(point[1] - self.centre[1], point[0] - self.centre[0]) - begin) % tau

    def way_to(self, point: Vector) -> float:
        """Return the length from its start to one of its points; of an arc, its angle [rad]."""
        if self.centre is None:
            return hypot(point[0] - self.start[0], point[1] - self.start[1])
        return self.turned(point)

    def holds(self, point: Vector) -> bool:
        """Return whether a point of its line or circle lies between its ends."""
        if self.centre is None:
            across, up = self.tangent(self.start)
            along = (point[0] - self.start[0]) * across + (point[1] - self.start[1]) * up
            return -NEAR <= along <= hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]) + NEAR
        slack = NEAR / (self.radius or 1.0)
        angle = self.turned(point)
        return angle <= self.turned(self.end) + slack or angle >= tau - slack

    def distance(self, point: Vector) -> float:
        """Return how far a point lies from it."""
        ends = min(hypot(point[0] - end[0], point[1] - end[1]) for end in (self.start, self.end))
        if self.centre is not None:
            aside = abs(hypot(point[0] - self.centre[0], point[1] - self.centre[1]) - self.radius)
            return aside if self.holds(point) else ends
        tangent = self.tangent(self.start)
        return abs(cross(tangent, (point[0] - self.start[0], point[1] - self.start[1]))) if self.holds(point) else ends

    def parallel(self, distance: float) -> Segment | None:
        """Return the same at a distance to its left; None where an arc shrinks to nothing."""
        if self.centre is None:
            across, up = self.tangent(self.start)
            step = -up * distance, across * distance
            return Segment(start=_plus(self.start, step), end=_plus(self.end, step))
        radius = self.radius
        if radius - self.sense * distance <= NEAR:
            return None
        share = 1.0 - self.sense * distance / radius
        return replace(self, start=_scaled(self.start, self.centre, share), end=_scaled(self.end, self.centre, share))


def cross(one: Vector, other: Vector) -> float:
    """Return how far ``other`` lies to the left of ``one``: the product of their lengths and the angle's sine."""
    return one[0] * other[1] - one[1] * other[0]


def meetings(one: Segment, other: Segment) -> list[Vector]:
    """Return the points that two segments have in common; none for lines on one another."""
    return [point for point in lines_meet(one, other) if one.holds(point) and other.holds(point)]


def lines_meet(one: Segment, other: Segment) -> list[Vector]:
    """Return the points that the whole lines or circles of two segments have in common."""
    if one.centre is None and other.centre is None:
        return _of_lines(one, other)
    if one.centre is not None and other.centre is not None:
        return _of_circles(one, other)
    return _of_line_and_circle(one, other) if one.centre is None else _of_line_and_circle(other, one)


def _of_lines(one: Segment, other: Segment) -> list[Vector]:
    first, second = one.tangent(one.start), other.tangent(other.start)
    share = cross(first, second)
    if abs(share) <= NEAR:
        return []
    along = cross((other.start[0] - one.start[0], other.start[1] - one.start[1]), second) / share
    return [(one.start[0] + along * first[0], one.start[1] + along * first[1])]


def _of_line_and_circle(line: Segment, arc: Segment) -> list[Vector]:
    """Return where a line cuts a circle: at sqrt(r^2 - h^2) to both sides of the foot of its centre."""
    assert arc.centre is not None
    across, up = line.tangent(line.start)
    away = arc.centre[0] - line.start[0], arc.centre[1] - line.start[1]
    along, aside = away[0] * across + away[1] * up, cross((across, up), away)
    rest = arc.radius * arc.radius - aside * aside
    if rest < -NEAR * arc.radius:
        return []
    half = sqrt(max(rest, 0.0))
    return [(line.start[0] + t * across, line.start[1] + t * up) for t in (along - half, along + half)]


def _of_circles(one: Segment, other: Segment) -> list[Vector]:
    """Return where two circles cut: on the line of equal powers, to both sides of the line of centres."""
    assert one.centre is not None
    assert other.centre is not None
    across, up = other.centre[0] - one.centre[0], other.centre[1] - one.centre[1]
    apart = hypot(across, up)
    if apart <= NEAR:
        return []
    along = (one.radius * one.radius - other.radius * other.radius + apart * apart) / (2.0 * apart)
    rest = one.radius * one.radius - along * along
    if rest < -NEAR * one.radius:
        return []
    half = sqrt(max(rest, 0.0)) / apart
    foot = one.centre[0] + along / apart * across, one.centre[1] + along / apart * up
    return [(foot[0] - side * up, foot[1] + side * across) for side in (half, -half)]


def _plus(one: Vector, other: Vector) -> Vector:
    return one[0] + other[0], one[1] + other[1]


def _scaled(point: Vector, centre: Vector, share: float) -> Vector:
    return centre[0] + share * (point[0] - centre[0]), centre[1] + share * (point[1] - centre[1])
