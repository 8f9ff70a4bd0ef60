"""How finely an encoder tells speed: by counts a period, or by the time of one count (1/T).

In: counts a unit, sampling period, clock.  Out: standard deviations, and the speed at which the two methods are equal.

    counts a period   a difference of two positions, each off by an even spread of one count:  sigma = q / (T sqrt 6)
    1/T               the time of one count is off by two even spreads of a clock tick:  sigma = v² tau / (q sqrt 6)

q is one count, T the period, tau the clock's tick; they are equal at v = q / sqrt(T tau).
"""

from __future__ import annotations

import math

_SPREAD = math.sqrt(6.0)  # of the difference of two even spreads of width 1: 1/√6, 0.408


def difference_noise(counts: float, period: float) -> float:
    """Return the standard deviation of speed by counts a period [s], for counts a unit of motion [units/s]."""
    return 1.0 / (counts * period * _SPREAD)


def period_noise(speed: float, counts: float, clock: float) -> float:
    """Return the standard deviation of speed by the time of one count, on a clock of a frequency [Hz] [units/s]."""
    return speed * speed * counts / (clock * _SPREAD)


def crossover(counts: float, period: float, clock: float) -> float:
    """Return the speed above which counting is the better of the two [units/s]."""
    return math.sqrt(clock / period) / counts
