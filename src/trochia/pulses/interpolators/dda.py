"""Digital differential analyser: two registers of size N add up the rates; an overflow is a step.

Line to (p, q):   dx = p/N, dy = q/N,  N = 2ⁿ > max(p, q);  N ticks in all, whatever the line's length.
Circle:           dx = -y dt, dy = x dt,  N = 2ⁿ > R;  the registers start half full, so that errors lie on both sides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.pulses.interpolators.frame import nearest_root, straight_on

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.pulses.interpolators.frame import Step


def register_size(greatest: int) -> int:
    """Return the least power of two above ``greatest``."""
    size = 1
    while size <= greatest:
        size <<= 1
    return size


def line(p: int, q: int) -> Iterator[Step]:
    """Yield the steps of a line to (p, q)."""
    size = register_size(max(p, q))
    sum_x = sum_y = done_x = done_y = 0
    while done_x < p or done_y < q:
        sum_x += p
        sum_y += q
        step_x, step_y = sum_x >= size, sum_y >= size
        if step_x:
            sum_x -= size
            done_x += 1
        if step_y:
            sum_y -= size
            done_y += 1
        yield step_x, step_y


def arc(x: int, y: int, x_end: int, y_end: int, radius_squared: int) -> Iterator[Step]:
    """Yield the steps of an arc in the frame's quadrant."""
    size = register_size(nearest_root(radius_squared))
    sum_x = sum_y = size >> 1
    while x > x_end and y < y_end:
        sum_x += y
        sum_y += x
        step_x, step_y = sum_x >= size, sum_y >= size
        if step_x:
            sum_x -= size
            x -= 1
        if step_y:
            sum_y -= size
            y += 1
        yield step_x, step_y
    yield from straight_on(x - x_end, y_end - y)
