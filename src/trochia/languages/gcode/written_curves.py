"""Curves in the few forms a plain controller has: arcs of one turn at most, and chords.

In: an arc or a cubic of a program, in machine coordinates [mm].  Out: the arcs or the points it is written as.
"""

from __future__ import annotations

from math import acos, atan2, ceil, cos, hypot, sin, sqrt, tau
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    Point = NDArray[np.float64]

SAME = 1e-7  #: ends of an arc nearer than this are one point, and the arc a whole turn [mm]


class Turn(NamedTuple):
    """One arc: its centre in the plane, its angle with sign [rad], radii at both ends, columns (first, second, up)."""

    centre: tuple[float, float]
    angle: float
    radii: tuple[float, float]
    columns: tuple[int, int, int]

    def point(self, start: Point, end: Point, share: float) -> Point:
        """Return the point (axes,) at a share of its angle, between its ends."""
        first, second, _ = self.columns
        begin = atan2(start[second] - self.centre[1], start[first] - self.centre[0])
        radius = self.radii[0] + share * (self.radii[1] - self.radii[0])
        at = start + share * (end - start)
        at[first] = self.centre[0] + radius * cos(begin + share * self.angle)
        at[second] = self.centre[1] + radius * sin(begin + share * self.angle)
        return at


def turn_of(start: Point, end: Point, centre: tuple[float, float], turns: int, columns: tuple[int, int, int]) -> Turn:
    """Return the arc of a move; ``turns`` counts those begun, positive counter-clockwise."""
    first, second, _ = columns
    here = start[first] - centre[0], start[second] - centre[1]
    there = end[first] - centre[0], end[second] - centre[1]
    sense = 1.0 if turns > 0 else -1.0
    part = sense * (atan2(there[1], there[0]) - atan2(here[1], here[0])) % tau
    if part * hypot(*here) <= SAME or (tau - part) * hypot(*here) <= SAME:
        part = tau
    return Turn(centre, sense * (part + tau * (abs(turns) - 1)), (hypot(*here), hypot(*there)), columns)


def whole_turns(turn: Turn, start: Point, end: Point) -> Iterator[tuple[Point, float]]:
    """Yield the arcs of at most one turn that an arc is made of: their ends (axes,) and angles [rad]."""
    count = max(1, ceil(abs(turn.angle) / tau - 1e-9))
    left = abs(turn.angle)
    sense = 1.0 if turn.angle > 0.0 else -1.0
    for number in range(count):
        angle = tau if number < count - 1 else left
        left -= angle
        yield (end if number == count - 1 else turn.point(start, end, 1.0 - left / abs(turn.angle))), sense * angle


def arc_chords(turn: Turn, start: Point, end: Point, chord: float) -> Iterator[Point]:
    """Yield the ends of chords that stay within ``chord`` [mm] of an arc; the last is its end."""
    radius = max(*turn.radii, chord)
    step = 2.0 * acos(max(1.0 - chord / radius, -1.0))
    count = max(1, ceil(abs(turn.angle) / step))
    for number in range(1, count):
        yield turn.point(start, end, number / count)
    yield end


def cubic_chords(points: Point, start: Point, end: Point, chord: float) -> Iterator[Point]:
    """Yield the ends of chords that stay within ``chord`` [mm] of a cubic Bezier curve (4, 3); the last is its end.

    n equal steps of the parameter leave at most ``|second difference| * 6 / (8 n^2)`` between curve and chord.
    """
    bend = float(np.max(np.linalg.norm(np.diff(points, n=2, axis=0), axis=1)))
    count = max(1, ceil(sqrt(0.75 * bend / chord)))
    for number in range(1, count):
        t = number / count
        weights = np.array([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3])
        at = start + t * (end - start)
        at[:3] = weights @ points
        yield at
    yield end
