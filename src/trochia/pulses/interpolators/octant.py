"""Direct evaluation of the function, octant by octant: the faster axis steps, the other goes to the rounded value.

Line:    y = q x/p (or x = p y/q where q > p), a division a tick.
Circle:  x = √(R² - y²) while x > y, then y = √(R² - x²): a square root a tick, and no error is ever carried on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.pulses.interpolators.frame import BOTH, X, Y, nearest_root, straight_on

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.pulses.interpolators.frame import Step


def line(p: int, q: int) -> Iterator[Step]:
    """Yield the steps of a line to (p, q)."""
    fast, slow, step = (p, q, X) if p >= q else (q, p, Y)
    done = 0
    for way in range(1, fast + 1):
        if (2 * way * slow + fast) // (2 * fast) > done:
            done += 1
            yield BOTH
        else:
            yield step


def arc(x: int, y: int, x_end: int, y_end: int, radius_squared: int) -> Iterator[Step]:
    """Yield the steps of an arc in the frame's quadrant."""
    while x > x_end and y < y_end:
        if x > y:
            step = BOTH if nearest_root(radius_squared - (y + 1) * (y + 1)) < x else Y
        else:
            step = BOTH if nearest_root(radius_squared - (x - 1) * (x - 1)) > y else X
        x, y = x - step[0], y + step[1]
        yield step
    yield from straight_on(x - x_end, y_end - y)
