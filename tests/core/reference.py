"""Plain statements of what the C core computes, in whole numbers without end: the C code is held equal to these."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def nearest_root(square: int) -> int:
    """The nearest whole number to a square root; halves cannot be."""
    root = math.isqrt(square)
    return root + (square > root * root + root)


def ramp(per_step: int, square: int, steps: int) -> list[int]:
    """Intervals of constant acceleration, or of braking where ``steps`` is below zero."""
    way = range(abs(steps) + 1)
    times = [nearest_root(square + (k if steps > 0 else -k) * per_step) for k in way]
    return [abs(after - before) for before, after in itertools.pairwise(times)]


def level(interval: int, steps: int) -> list[int]:
    """Intervals at constant speed, given in 2^-8 ticks: the tick each step falls in, in differences."""
    times = [k * interval // 256 for k in range(steps + 1)]
    return [after - before for before, after in itertools.pairwise(times)]


def speed_move(up_per_step: int, down_per_step: int, counts: Sequence[int], interval: int) -> list[int]:
    """A whole move: up, at speed, down to rest."""
    up, steady, down = counts
    return ramp(up_per_step, 0, up) + level(interval, steady) + ramp(down_per_step, down * down_per_step, -down)


def segments(rows: Iterable[Sequence[int]], fraction: int = 0) -> list[int]:
    """Intervals of tick segments (interval, add, add2, count, stride, flags), everything in 2^-24 ticks."""
    made: list[int] = []
    for interval, add, add2, count, stride, flags in rows:
        scale = 8 * (flags >> 2 & 3)
        value, slope, bend = interval << 16, add << scale, add2 << scale
        for step in range(1, count + 1):
            fraction += value >> 16
            made.append(fraction >> 8)
            fraction &= 0xFF
            if step % stride == 0:
                value, slope = (value + slope) % 2**48, slope + bend
    return made
