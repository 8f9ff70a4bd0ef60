"""Lengths, speeds and accelerations of a stepper as a person types them, to steps.

"400 steps", "2 turns", "90 deg"; "200 rpm", "20.9 rad/s", "670 steps/s"; "100 rad/s²", "3000 steps/s²"; and, where the
travel of a turn is known, "100 mm", "50 mm/s", "2000 mm/s²".
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import click

from trochia import units
from trochia.errors import UnitError

_NUMBER = r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*"
_STEPS = re.compile(_NUMBER + r"steps?(/s(?:²|\^2|2)?)?\s*\Z")
_ORDERS = {None: 0, "/s": 1}  #: of "steps", "steps/s"; all else is 2
_LIKE = (
    '"400 steps", "2 turn" or "90 deg"',
    '"200 rpm", "21 rad/s" or "670 steps/s"',
    '"100 rad/s²" or "3000 steps/s²"',
)
_MM = ('"100 mm"', '"50 mm/s"', '"2000 mm/s²"')
_LINEAR = ("length", "velocity", "acceleration")
_ANGULAR = ("angle", "angular velocity", "angular acceleration")


@dataclass(frozen=True, slots=True, kw_only=True)
class StepScale:
    """Steps of a turn of the shaft, and what a turn moves [mm, or degree where ``rotary``]; None: nobody said."""

    per_turn: int
    travel: float | None = None
    rotary: bool = False

    def length(self, text: str, option: str) -> float:
        """Return a length [steps].

        Raises
        ------
        click.BadParameter
            For a text that is none, or one that is not above 0.
        """
        return _positive(self._steps(text, 0, option), text, option)

    def speed(self, text: str, option: str) -> float:
        """Return a speed [steps/s]; errors as in :meth:`length`."""
        if any(text.strip().endswith(unit) for unit in ("rpm", "r/min")):
            value = quantity(text, "rotation speed", option) / 60.0 * self.per_turn
        else:
            value = self._steps(text, 1, option)
        return _positive(value, text, option)

    def acceleration(self, text: str, option: str) -> float:
        """Return an acceleration [steps/s²]; errors as in :meth:`length`."""
        return _positive(self._steps(text, 2, option), text, option)

    def _steps(self, text: str, order: int, option: str) -> float:
        """Return a length, speed or acceleration (``order`` 0, 1, 2) in steps."""
        text = text.strip().removesuffix("turns") + "turn" if text.strip().endswith("turns") else text
        match = _STEPS.match(text)
        if match and _ORDERS.get(match.group(2), 2) == order:
            return float(match.group(1))
        try:
            along = units.parse(text, _LINEAR[order])
        except UnitError:
            like = f"like {_LIKE[order]}" + (
                f", or {_MM[order]}" if self.travel is not None and not self.rotary else ""
            )
            degrees = quantity(text, _ANGULAR[order], option, like)
            # where the joint itself turns, angles are the joint's, as in its file
            turn = self.travel if self.rotary and self.travel else 360.0
            return degrees / turn * self.per_turn
        if self.travel is None or self.rotary:
            raise click.BadParameter(
                f"{text!r} is along an axis, not {_LIKE[order]}: "
                + ("this one turns" if self.rotary else 'say what a turn moves it, --travel-per-turn "5 mm"'),
                param_hint=option,
            )
        return along / self.travel * self.per_turn


def speed(text: str, steps_per_turn: int, option: str) -> float:
    """Return a speed [steps/s]; errors as in :meth:`StepScale.length`."""
    return StepScale(per_turn=steps_per_turn).speed(text, option)


def positive(text: str, dimension: str, option: str) -> float:
    """Return a quantity above 0 in its base unit; errors as in :meth:`StepScale.length`."""
    return _positive(quantity(text, dimension, option), text, option)


def quantity(text: str, dimension: str, option: str, instead: str | None = None) -> float:
    """Return a quantity in its base unit; ``instead`` names other texts that would do."""
    try:
        return units.parse(text, dimension)
    except UnitError as error:
        message = error.message if instead is None else f"expected one {instead}, not {text!r}"
        raise click.BadParameter(message, param_hint=option) from error


def fraction(text: str, option: str, *, least: float | None = None) -> float:
    """Return a percentage above 0 (or from ``least`` on) to 100 as a fraction; errors as in :func:`positive`."""
    try:
        value = float(text.strip().removesuffix("%")) / 100.0
    except ValueError:
        raise click.BadParameter(f'expected a percentage, like "5 %", not {text!r}', param_hint=option) from None
    lowest = 0.0 if least is None else least
    if not lowest <= value <= 1.0 or (least is None and value == 0.0):
        above = "more than 0 %" if least is None else f"at least {lowest:.0%}"
        raise click.BadParameter(f"expected {above} and at most 100 %, not {text!r}", param_hint=option)
    return value


def _positive(value: float, text: str, option: str) -> float:
    """Return the value if it is above 0."""
    if not 0.0 < value < math.inf:
        raise click.BadParameter(f"must be more than 0, not {text!r}: such a move never arrives", param_hint=option)
    return value
