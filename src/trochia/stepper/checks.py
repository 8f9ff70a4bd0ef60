"""What a user hands over, looked at: numbers that can be, or an error that says which would do.

In: anything.  Out: a whole number of steps, or a quantity within bounds.
"""

from __future__ import annotations

import math
from numbers import Real

from trochia.errors import LimitError

FARTHEST = 2**53  #: position, either way [steps]: beyond, doubles skip whole numbers
SPEEDS = 1e-6, 1e9  #: [steps/s]
ACCELERATIONS = 1e-6, 1e12  #: [steps/s²]
TURNS = 1e-3, 1e5  #: [rpm]


def whole(name: str, value: object) -> int:
    """Return a position or a count [steps]; a float that is whole will do.

    Raises
    ------
    LimitError
        For anything else, and beyond 2⁵³ either way.
    """
    number = _number(value)
    if not math.isfinite(number) or number != math.floor(number):
        raise LimitError(f"the {name} must be a whole number of steps, not {value!r}",
                         hint="round() it; half steps and microsteps are steps of their own.")  # fmt: skip
    if abs(number) > FARTHEST:
        raise LimitError(f"the {name} must lie within ±{FARTHEST} steps, not {value!r}")
    return int(number)


def speed(name: str, value: object) -> float:
    """Return a speed above 0 [steps/s]; errors as of :func:`positive`."""
    return positive(name, value, "steps/s", SPEEDS, "To stand still, stop().")


def acceleration(name: str, value: object) -> float:
    """Return an acceleration above 0 [steps/s²]; errors as of :func:`positive`."""
    return positive(name, value, "steps/s²", ACCELERATIONS, "For steps without a ramp, set_speed() and run_speed().")


def positive(name: str, value: object, unit: str, bounds: tuple[float, float], hint: str) -> float:
    """Return a quantity within bounds, both above 0.

    Raises
    ------
    LimitError
        Outside of them, and for what is no number.
    """
    number = _number(value)
    if math.isnan(number):
        raise LimitError(f"the {name} must be a number of {unit}, not {value!r}")
    if not number > 0.0:
        raise LimitError(f"the {name} must be more than 0 {unit}, not {number:g}", hint=hint)
    if not bounds[0] <= number <= bounds[1]:
        raise LimitError(f"the {name} must be from {bounds[0]:g} to {bounds[1]:g} {unit}, not {number:g}")
    return number


def finite(name: str, value: object, unit: str) -> float:
    """Return a number, of either sign or 0.

    Raises
    ------
    LimitError
        For one that is not finite, and for what is no number.
    """
    number = _number(value)
    if not math.isfinite(number):
        raise LimitError(f"the {name} must be a number of {unit}, not {value!r}")
    return number


def _number(value: object) -> float:
    """Return a number as a double; not a number for anything else, infinite for one that no double holds."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf
