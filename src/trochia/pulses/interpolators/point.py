"""Point-by-point method: one axis at a time, always back across the curve; the discriminant's sign says which.

Line:    F = p y - q x;  at or above the line a step of x, below it one of y;  p + q ticks.
Circle:  F = x² + y² - R²;  on or outside a step inwards (x - 1), inside one along (y + 1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.pulses.interpolators.frame import X, Y, straight_on

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.pulses.interpolators.frame import Step


def line(p: int, q: int) -> Iterator[Step]:
    """Yield the steps of a line to (p, q)."""
    f = 0
    left_x, left_y = p, q
    while left_x and left_y:
        if f >= 0:
            f -= q
            left_x -= 1
            yield X
        else:
            f += p
            left_y -= 1
            yield Y
    yield from straight_on(left_x, left_y)


def arc(x: int, y: int, x_end: int, y_end: int, radius_squared: int) -> Iterator[Step]:
    """Yield the steps of an arc in the frame's quadrant."""
    f = x * x + y * y - radius_squared
    while x > x_end and y < y_end:
        if f >= 0:
            f -= 2 * x - 1
            x -= 1
            yield X
        else:
            f += 2 * y + 1
            y += 1
            yield Y
    yield from straight_on(x - x_end, y_end - y)
