"""Bresenham's method: of the neighbours ahead, the one whose discriminant is nearest to zero.

Line:    the faster axis steps at every tick, the slower where the middle between its two points has been passed.
Circle:  F(x, y) = x² + y² - R²; across (x - 1), along (y + 1), or both, whichever leaves the least |F|.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.pulses.interpolators.frame import BOTH, X, Y, straight_on

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.pulses.interpolators.frame import Step


def line(p: int, q: int) -> Iterator[Step]:
    """Yield the steps of a line to (p, q)."""
    fast, slow, step = (p, q, X) if p >= q else (q, p, Y)
    past = -fast  # twice how far the slow axis is past the middle, in 1/fast of a step
    for _ in range(fast):
        past += 2 * slow
        if past < 0:
            yield step
        else:
            past -= 2 * fast
            yield BOTH


def arc(x: int, y: int, x_end: int, y_end: int, radius_squared: int) -> Iterator[Step]:
    """Yield the steps of an arc in the frame's quadrant."""
    f = x * x + y * y - radius_squared
    while x > x_end and y < y_end:
        across, along = f - 2 * x + 1, f + 2 * y + 1
        both = across + along - f
        if both < 0 and along + both <= 0:  # inside, and out along y is nearer
            step, f = Y, along
        elif both > 0 and across + both > 0:  # outside, and in across x is nearer
            step, f = X, across
        else:
            step, f = BOTH, both
        x, y = x - step[0], y + step[1]
        yield step
    yield from straight_on(x - x_end, y_end - y)
