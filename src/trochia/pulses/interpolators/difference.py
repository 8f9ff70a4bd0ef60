"""Coordinate-difference method: the law of motion, sampled; the differences are the axes' pulse rates until the next.

At every eighth tick the law x(t), y(t) of uniform motion along the curve is evaluated; what each axis lacks to it is
sent as so many pulses, spread evenly over the eight ticks.  So the speed along the curve is the same in any direction.

Line:    x = p t/T, y = q t/T, with T the line's length in ticks.
Circle:  (x, y) turned by w = 2⁻ᵐ a sample, cos w ≈ 1 - w²/2 and sin w ≈ w: shifts and additions only, and the radius
         grows by no more than w⁴/8 of itself a sample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.pulses.interpolators.frame import nearest_root, root, straight_on

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.pulses.interpolators.frame import Step

SAMPLE = 8  #: ticks from sample to sample
FRACTION = 24  #: bits of a step's fraction in the circle's law


def spread(rate_x: int, rate_y: int, ticks: int) -> Iterator[Step]:
    """Yield ``rate_x`` and ``rate_y`` steps, each spread evenly over ``ticks``."""
    sum_x = sum_y = ticks >> 1
    for _ in range(ticks):
        sum_x += rate_x
        sum_y += rate_y
        step_x, step_y = sum_x >= ticks, sum_y >= ticks
        if step_x:
            sum_x -= ticks
        if step_y:
            sum_y -= ticks
        yield step_x, step_y


def line(p: int, q: int) -> Iterator[Step]:
    """Yield the steps of a line to (p, q)."""
    square = p * p + q * q
    length = root(square)
    if length * length < square:
        length += 1
    x = y = time = 0
    while time < length:
        ticks = min(SAMPLE, length - time)
        time += ticks
        rate_x = (2 * p * time + length) // (2 * length) - x
        rate_y = (2 * q * time + length) // (2 * length) - y
        for step_x, step_y in spread(rate_x, rate_y, ticks):
            if x == p and y == q:
                return  # the last tick may be empty
            x, y = x + step_x, y + step_y
            yield step_x, step_y


def shifted(value: int, bits: int) -> int:
    """Return ``value`` / 2^bits to the nearest whole, halves away from zero."""
    half = 1 << (bits - 1)
    return (value + half) >> bits if value >= 0 else -((-value + half) >> bits)


def arc(x: int, y: int, x_end: int, y_end: int, radius_squared: int) -> Iterator[Step]:
    """Yield the steps of an arc in the frame's quadrant."""
    radius, shift = nearest_root(radius_squared), 3
    while radius >> shift >= SAMPLE:
        shift += 1
    law_x, law_y = x << FRACTION, y << FRACTION
    while x > x_end and y < y_end:
        law_x, law_y = (
            law_x - shifted(law_y, shift) - shifted(law_x, 2 * shift + 1),
            law_y + shifted(law_x, shift) - shifted(law_y, 2 * shift + 1),
        )
        rate_x = min(max(x - shifted(law_x, FRACTION), 0), SAMPLE)
        rate_y = min(max(shifted(law_y, FRACTION) - y, 0), SAMPLE)
        for step_x, step_y in spread(rate_x, rate_y, SAMPLE):
            if x == x_end or y == y_end:
                break
            x, y = x - step_x, y + step_y
            yield step_x, step_y
    yield from straight_on(x - x_end, y_end - y)
