"""Functions and operators of expressions: what they are called, how tightly they bind, what they refuse.

In: numbers.  Out: numbers, or :class:`Refusal`, which says what cannot be worked out; who knows the line turns it into
an error that points at the place.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

EQUAL = 1e-4  #: values nearer than this are EQ


class Refusal(Exception):  # noqa: N818 - it becomes an error only with its place
    """A value that cannot be worked out: what is wrong, and what to do."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def _divide(left: float, right: float) -> float:
    if right == 0.0:
        raise Refusal("division by zero", "Check the divisor before: o1 if [#1 NE 0].")
    return left / right


def _modulo(left: float, right: float) -> float:
    """Return the remainder that is not negative, whatever the signs."""
    if right == 0.0 or math.isinf(left):
        return math.nan
    rest = math.fmod(left, right)
    return rest + abs(right) if rest < 0.0 else rest


def _power(left: float, right: float) -> float:
    if left < 0.0 and right != math.floor(right):
        raise Refusal("a negative number has no power that is no integer", "Use ABS, or an integer exponent.")
    try:
        return math.pow(left, right)
    except OverflowError:
        return math.inf
    except ValueError:  # 0 to a negative power
        return math.inf


def _round(value: float) -> float:
    """Return the nearest integer; halves go away from zero."""
    return float(math.floor(value + 0.5)) if value >= 0.0 else -float(math.floor(0.5 - value))


def _logarithm(value: float) -> float:
    if value <= 0.0:
        raise Refusal(f"LN of {value:g}, which is not above zero", "Check the value before.")
    return math.log(value)


def _root(value: float) -> float:
    if value < 0.0:
        raise Refusal(f"SQRT of {value:g}, which is negative", "Check the value before, or use ABS.")
    return math.sqrt(value)


def _arc(name: str, function: Callable[[float], float]) -> Callable[[float], float]:
    def angle(value: float) -> float:
        if not -1.0 <= value <= 1.0:
            raise Refusal(f"{name} of {value:g}, which is not within -1 and 1", "Check the value before.")
        return math.degrees(function(value))

    return angle


def _exponential(value: float) -> float:
    try:
        return math.exp(value)
    except OverflowError:
        return math.inf


def _of_angle(function: Callable[[float], float]) -> Callable[[float], float]:
    return lambda degrees: function(math.radians(degrees))


def _whole(function: Callable[[float], int]) -> Callable[[float], float]:
    return lambda value: float(function(value))


def arc_tangent(up: float, along: float) -> float:
    """Return the angle of the direction (along, up) [degree], -180 to 180."""
    return math.degrees(math.atan2(up, along))


FUNCTIONS: dict[str, Callable[[float], float]] = {
    "abs": abs,
    "acos": _arc("ACOS", math.acos),
    "asin": _arc("ASIN", math.asin),
    "cos": _of_angle(math.cos),
    "exp": _exponential,
    "fix": _whole(math.floor),
    "fup": _whole(math.ceil),
    "ln": _logarithm,
    "round": _round,
    "sin": _of_angle(math.sin),
    "sqrt": _root,
    "tan": _of_angle(math.tan),
}  #: name -> function of one argument; ATAN and EXISTS have a form of their own

Operator = tuple[int, "Callable[[float, float], float]"]

OPERATORS: dict[str, Operator] = {
    "**": (5, _power),
    "*": (4, lambda left, right: left * right),
    "/": (4, _divide),
    "mod": (4, _modulo),
    "+": (3, lambda left, right: left + right),
    "-": (3, lambda left, right: left - right),
    "eq": (2, lambda left, right: 1.0 if abs(left - right) < EQUAL else 0.0),
    "ne": (2, lambda left, right: 0.0 if abs(left - right) < EQUAL else 1.0),
    "gt": (2, lambda left, right: 1.0 if left > right else 0.0),
    "ge": (2, lambda left, right: 1.0 if left >= right else 0.0),
    "lt": (2, lambda left, right: 1.0 if left < right else 0.0),
    "le": (2, lambda left, right: 1.0 if left <= right else 0.0),
    "and": (1, lambda left, right: 1.0 if left and right else 0.0),
    "or": (1, lambda left, right: 1.0 if left or right else 0.0),
    "xor": (1, lambda left, right: 1.0 if bool(left) != bool(right) else 0.0),
}  #: text -> how tightly it binds, and what it does; equals bind from the left

OPERATOR = re.compile(r"\*\*|[*/+-]|mod|eq|ne|gt|ge|lt|le|and|or|xor")
FUNCTION = re.compile("atan|exists|" + "|".join(FUNCTIONS))


def finite(value: float) -> float:
    """Return the value, unless it is infinite or no number."""
    if value - value != 0.0:
        raise Refusal("the result is no finite number" if math.isnan(value) else "the result is infinite",
                      "Check the numbers it is made of.")  # fmt: skip
    return value
