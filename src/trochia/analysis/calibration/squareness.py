"""The angle between two axes from lengths: a square's diagonals, or how far a square is left.

In: lengths, and the instrument's resolution.  Out: the angle beyond 90 degrees, with its uncertainty (k = 2).  Legend:
a, b sides, d1 the diagonal from corner (-, -) to (+, +), d2 the other.
"""

from __future__ import annotations

import math

from trochia.errors import ConfigError

_COVER = 2.0
ASIDE = 0.02  #: by which part d1² + d2² may differ from 2 (a² + b²)


def by_diagonals(first: float, second: float, sides: tuple[float, float], *, resolution: float) -> tuple[float, float]:
    """Return (angle, uncertainty) [degree]: d1² - d2² = 4 a b cos(90° + angle).

    Raises
    ------
    ConfigError
        When no parallelogram has these lengths.
    """
    product = 4.0 * sides[0] * sides[1]
    sine = (second**2 - first**2) / product
    whole = first**2 + second**2
    asked = 2.0 * (sides[0] ** 2 + sides[1] ** 2)
    if not (abs(sine) < 1.0 and abs(whole - asked) < ASIDE * asked):
        told = f"no parallelogram of sides {sides[0]:g} and {sides[1]:g} has diagonals {first:g} and {second:g}"
        raise ConfigError(told, key="diagonal")
    # each diagonal is a difference of two readings
    sure = _COVER * math.hypot(first, second) * 2.0 * resolution * math.sqrt(2.0 / 12.0) / product
    return math.degrees(math.asin(sine)), math.degrees(sure)


def by_deviation(deviation: float, over: float, *, resolution: float) -> tuple[float, float]:
    """Return (angle, uncertainty) [degree] from how far the first axis is off to plus along ``over`` of the second.

    The angle is beyond 90 degrees where going along the second takes the first to minus.

    Raises
    ------
    ConfigError
        For a way that is not above zero.
    """
    if not over > 0.0:
        raise ConfigError(f"must be above zero, not {over:g}", key="over")
    sure = _COVER * resolution * math.sqrt(2.0 / 12.0) / over
    return math.degrees(math.atan(-deviation / over)), math.degrees(sure)
