"""The step library's rule: after each step the speed grows by a/v, and never exceeds what the way left allows (S1 A10).

The first speed √(2a) is that of the exact law at the *end* of the first step, so the first delay is half of the exact
one.  Whole-millisecond delays, which the early library makes of these, are no part of the rule.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.ramps.demand import Demand


def next_speed(speed: float, left: int, acceleration: float, deceleration: float, limit: float) -> float:
    """Return the speed for the next step [steps/s], 0 at the target; ``left`` steps to go, forwards (S1 E27)."""
    if left == 0:
        return 0.0
    allowed = math.sqrt(2.0 * left * deceleration)
    if allowed > speed:
        return min(math.sqrt(2.0 * acceleration) if speed == 0.0 else speed + acceleration / speed, limit)
    if allowed < speed:
        return max(speed - deceleration / speed, 0.0)
    return allowed


def delays(demand: Demand) -> NDArray[np.float64]:
    """Return the delay before each step (steps,) [s]."""
    up, down, limit = demand.rising, demand.falling, demand.speed
    speed = 0.0
    speeds: list[float] = []
    for left in range(demand.steps, 0, -1):
        following = next_speed(speed, left, up, down, limit)
        # the last speed's fall by a/v may overshoot rest; the way left still allows √(2a)
        speed = following if following > 0.0 else math.sqrt(2.0 * down * left)
        speeds.append(speed)
    return 1.0 / np.array(speeds)
