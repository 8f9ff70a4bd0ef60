"""Speeds and accelerations of a stepper as a person types them, to steps: "200 rpm", "20.9 rad/s", "670 steps/s"."""

from __future__ import annotations

import math
import re

import click

from trochia import units
from trochia.errors import UnitError

_STEPS = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*steps?/s(²|\^2|2)?\s*\Z")


def speed(text: str, steps_per_turn: int, option: str) -> float:
    """Return a speed [steps/s].

    Raises
    ------
    click.BadParameter
        For a text that is no speed, or one that is not above 0.
    """
    match = _STEPS.match(text)
    if match and not match.group(2):
        return _positive(float(match.group(1)), text, option)
    dimension = "angular velocity"
    if any(text.strip().endswith(unit) for unit in ("rpm", "r/min")):
        turns = quantity(text, "rotation speed", option) / 60.0
    else:
        turns = quantity(text, dimension, option, 'like "200 rpm", "21 rad/s" or "670 steps/s"') / 360.0
    return _positive(turns * steps_per_turn, text, option)


def acceleration(text: str, steps_per_turn: int, option: str) -> float:
    """Return an acceleration [steps/s²]; errors as in :func:`speed`."""
    match = _STEPS.match(text)
    if match and match.group(2):
        return _positive(float(match.group(1)), text, option)
    degrees = quantity(text, "angular acceleration", option, 'like "100 rad/s²" or "3000 steps/s²"')
    return _positive(degrees / 360.0 * steps_per_turn, text, option)


def positive(text: str, dimension: str, option: str) -> float:
    """Return a quantity above 0 in its base unit; errors as in :func:`speed`."""
    return _positive(quantity(text, dimension, option), text, option)


def quantity(text: str, dimension: str, option: str, instead: str | None = None) -> float:
    """Return a quantity in its base unit; ``instead`` names other texts that would do."""
    try:
        return units.parse(text, dimension)
    except UnitError as error:
        message = error.message if instead is None else f"expected one {instead}, not {text!r}"
        raise click.BadParameter(message, param_hint=option) from error


def fraction(text: str, option: str) -> float:
    """Return a percentage above 0 and at most 100 as a fraction; errors as in :func:`speed`."""
    try:
        value = float(text.strip().removesuffix("%")) / 100.0
    except ValueError:
        raise click.BadParameter(f'expected a percentage, like "5 %", not {text!r}', param_hint=option) from None
    if not 0.0 < value <= 1.0:
        raise click.BadParameter(f"expected more than 0 % and at most 100 %, not {text!r}", param_hint=option)
    return value


def _positive(value: float, text: str, option: str) -> float:
    """Return the value if it is above 0."""
    if not 0.0 < value < math.inf:
        raise click.BadParameter(f"must be more than 0, not {text!r}: such a move never arrives", param_hint=option)
    return value
