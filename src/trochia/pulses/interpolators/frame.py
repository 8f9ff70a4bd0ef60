"""Figures in whole steps, and the one frame every interpolator sees them in.

In: a line, or an arc about its centre.  Out: the pieces a method works on, and what its steps are on the real axes.

A line goes from (0, 0) to (p, q) with p and q at least 0.  An arc is cut where it meets the axes; in its quadrant it
runs counter-clockwise through x > 0, y ≥ 0, so that x only falls and y only rises; clockwise is the same with x and y
swapped.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Iterator

#: One tick in the frame: whether x and whether y makes a step.
Step = tuple[bool, bool]
Point = tuple[int, int]

_ROUNDING = 0.75  # steps: a rounded point is at most half a diagonal, 0.71, from its circle
X, Y, BOTH = (True, False), (False, True), (True, True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A straight way from (0, 0) to (x, y) [steps]."""

    x: int
    y: int

    @property
    def length(self) -> float:
        """Length [steps]."""
        return math.hypot(self.x, self.y)


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """A way along a circle about (0, 0); a whole turn where start and end are one point.

    Attributes
    ----------
    start, end
        The points of the grid nearest to the true ends [steps].
    radius_squared
        Of the true circle [steps²]; whole, though the radius need not be.
    clockwise
        Which way round.
    """

    start: Point
    end: Point
    radius_squared: int
    clockwise: bool = False

    def __post_init__(self) -> None:
        greatest = nearest_root(self.radius_squared)
        for name, point in (("start", self.start), ("end", self.end)):
            away = math.hypot(*point)
            if self.radius_squared < 1 or abs(away - self.radius) > _ROUNDING or max(map(abs, point)) > greatest:
                raise ConfigError(
                    f"the arc's {name} {point} lies {away:.2f} steps from its centre, not {self.radius:.2f}",
                    hint="Give the point of the grid that is nearest to the circle.",
                )
        if _backwards(self):
            raise ConfigError(f"no arc of radius {self.radius:.2f} steps goes from {self.start} to {self.end}",
                              hint="Both must be the grid's nearest points to one circle.")  # fmt: skip

    @property
    def radius(self) -> float:
        """Radius of the true circle [steps]."""
        return math.sqrt(self.radius_squared)


Figure = Line | Arc


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """An arc's part in one quadrant, in the frame: from (x, y), x falling to ``x_end`` and y rising to ``y_end``.

    Attributes
    ----------
    x_step, y_step
        What a step of the frame's x and y is on the real axes.
    """

    x: int
    y: int
    x_end: int
    y_end: int
    x_step: Point
    y_step: Point


def turned(point: Point, quarters: int) -> Point:
    """Return a point turned counter-clockwise by quarters of a turn, exactly."""
    x, y = point
    return ((x, y), (-y, x), (-x, -y), (y, -x))[quarters % 4]


def _swapped(arc: Arc, point: Point) -> Point:
    """Return a point as the counter-clockwise frame has it, or back."""
    return (point[1], point[0]) if arc.clockwise else point


def _first_quarter(arc: Arc) -> int:
    """Return by how many quarters of a turn the start lies beyond the frame's quadrant."""
    first = _swapped(arc, arc.start)
    return next(k for k in range(4) if turned(first, -k)[0] > 0 and turned(first, -k)[1] >= 0)


def _backwards(arc: Arc) -> bool:
    """Whether the end is the next to come by its angle, and yet a coordinate would have to go back to it."""
    quarters = _first_quarter(arc)
    (x, y), end = (turned(_swapped(arc, point), -quarters) for point in (arc.start, arc.end))
    return min(end) >= 0 and x * end[1] - y * end[0] > 0 and not _ahead(x, y, end)


def _ahead(x: int, y: int, end: Point) -> bool:
    """Whether ``end`` lies ahead of (x, y) in the frame's quadrant."""
    return 0 <= end[0] <= x and end[1] >= y and (x, y) != end


def pieces(arc: Arc) -> Iterator[Piece]:
    """Yield an arc quadrant by quadrant."""
    radius, quarters = nearest_root(arc.radius_squared), _first_quarter(arc)
    first, last = _swapped(arc, arc.start), _swapped(arc, arc.end)
    x, y = turned(first, -quarters)
    done = False
    while not done:
        end = turned(last, -quarters)
        done = _ahead(x, y, end)
        x_end, y_end = end if done else (0, radius)
        x_step, y_step = (_swapped(arc, turned(step, quarters)) for step in ((-1, 0), (0, 1)))
        yield Piece(x=x, y=y, x_end=x_end, y_end=y_end, x_step=x_step, y_step=y_step)
        x, y, quarters = radius, 0, quarters + 1


def straight_on(steps_x: int, steps_y: int) -> Iterator[Step]:
    """Yield what is left of a piece when one axis is done: the other's steps."""
    for _ in range(steps_x):
        yield X
    for _ in range(steps_y):
        yield Y


def root(value: int) -> int:
    """Return the greatest r with r² ≤ value, bit by bit, as a chip without division does it."""
    result, bit = 0, 1
    while bit << 2 <= value:
        bit <<= 2
    while bit:
        if value >= result + bit:
            value -= result + bit
            result = (result >> 1) + bit
        else:
            result >>= 1
        bit >>= 2
    return result


def nearest_root(value: int) -> int:
    """Return the square root to the nearest whole, 0 below 0."""
    if value <= 0:
        return 0
    result = root(value)
    return result + 1 if value - result * result > result else result
