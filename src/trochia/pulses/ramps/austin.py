"""Austin's recursion: each delay from the one before by one division (S1 E14, E15, A5, A8).

c₀ = 0.676 √(2/a), cₙ = cₙ₋₁ - 2 cₙ₋₁/(4n + 1); braking the same with n counted from the end, negative.  Left alone the
recursion stays 1/0.67598 too slow for ever, because its first ratio is 45 % off; the factor puts the whole error into
the first step, which is 32 % too short, and makes the later delays right to 0.1 % from the tenth on.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.ramps.demand import Demand

FIRST = 0.676  #: what the first delay is shortened by


def first_delay(acceleration: float) -> float:
    """Return c₀ for an acceleration [steps/s²], in seconds (S1 E13)."""
    return FIRST * math.sqrt(2.0 / acceleration)


def recursion(first: float, count: int) -> NDArray[np.float64]:
    """Return c₀ to the delay of index ``count`` (count + 1,), in the unit of ``first``."""
    n = np.arange(1, count + 1, dtype=np.float64)
    ratios = np.ones(count + 1)
    np.cumprod((4.0 * n - 1.0) / (4.0 * n + 1.0), out=ratios[1:])
    return first * ratios


def braking(last: float, count: int) -> NDArray[np.float64]:
    """Return the ``count`` delays that follow the delay ``last`` up to rest (count,), in its unit (S1 E15)."""
    n = np.arange(count, 0, -1, dtype=np.float64)
    ratios = np.ones(count)
    np.cumprod((4.0 * n + 1.0) / (4.0 * n - 1.0), out=ratios)
    return last * ratios


def delays(demand: Demand) -> NDArray[np.float64]:
    """Return the delay before each step (steps,) [s]: speed up to the shortest delay 1/v, hold, brake (S1 A7, A8)."""
    up, down = demand.rising, demand.falling
    shortest = 1.0 / demand.speed
    first = max(first_delay(up), shortest)  # a speed below the first step's is kept from the start
    whole = int(demand.speed**2 / (2.0 * up))
    limit = int(demand.steps * down / (up + down))
    # the text of the source takes `limit` here, which would brake far too early (S1 section 6, item 11)
    slow = int(whole * up / down) if whole < limit else demand.steps - limit
    brake = demand.steps - min(slow, demand.steps - 1)
    ramp = recursion(first, min(brake, whole + 2) - 1)
    held = np.full(brake, shortest)
    held[: ramp.size] = np.maximum(ramp, shortest)
    return np.concatenate((held, braking(held[-1], demand.steps - brake)))
