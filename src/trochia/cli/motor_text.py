"""A motor as a person names it: of the library, of a file of motors, or its numbers as they stand in a catalogue.

In: a text.  Out: a row of a catalogue, and what to call it.
"""

from __future__ import annotations

from typing import Any

import click

from trochia import units
from trochia.cli.motor_options import named
from trochia.errors import ConfigError, UnitError
from trochia.machine.motors.catalogue import CatalogueStepper

EXAMPLE = '"1.7 A, 1.65 ohm, 3.2 mH, 44 N·cm, 68 g·cm²"'
_OPTION = "--motor"
#: dimension -> key of the row; a number is known by its unit
_KEYS = {"current": "current", "resistance": "resistance", "inductance": "inductance", "torque": "holding_torque",
         "inertia": "inertia", "angle": "step", "voltage": "voltage"}  # fmt: skip
_WORDS = {"detent": "detent_torque", "friction": "friction"}  #: a torque after one of these words is not what it holds
_NEEDED = ("current", "resistance", "inductance", "holding_torque", "inertia")


def motor_row(text: str) -> tuple[str, CatalogueStepper]:
    """Return what to call a motor, and its row.

    Raises
    ------
    click.BadParameter
        For a list of numbers with something missing in it.
    ConfigError
        For a name that there is not, numbers that do not belong together, a file that has them wrong.
    """
    if "," in text:
        return "typed motor", _of_numbers(text)
    try:
        return text.rpartition(".toml:")[2].rpartition("/")[2], named(text)
    except ConfigError as error:
        if error.source is not None:
            raise
        hint = f"{error.hint or ''} Its numbers would do as well, like {EXAMPLE}"
        raise ConfigError(error.message, hint=hint.strip()) from None


def _of_numbers(text: str) -> CatalogueStepper:
    """Return the row of a list of numbers with units."""
    found: dict[str, Any] = {}
    for part in text.split(","):
        key, value = _number(part.strip())
        if key in found:
            raise click.BadParameter(f"{part.strip()!r} is a second {key.replace('_', ' ')}", param_hint=_OPTION)
        found[key] = value
    missing = [key.replace("_", " ") for key in _NEEDED if key not in found]
    if missing:
        raise click.BadParameter(f"the motor's {', '.join(missing)} is missing; all of it, like {EXAMPLE}",
                                 param_hint=_OPTION)  # fmt: skip
    step = found.pop("step", 1.8)
    if not 0.0 < step <= 90.0 or abs(360.0 / step - round(360.0 / step)) > 1e-6:
        raise click.BadParameter(f"a step of {step:g} degrees does not divide a turn; 1.8 or 0.9 would do",
                                 param_hint=_OPTION)  # fmt: skip
    return CatalogueStepper(full_steps=round(360.0 / step), **found)


def _number(part: str) -> tuple[str, float]:
    """Return the key and the value of one number with its unit, or of a word and a torque."""
    word, _, rest = part.partition(" ")
    for dimension, key in ({"torque": _WORDS[word]} if word in _WORDS else _KEYS).items():
        try:
            return key, units.parse(rest if word in _WORDS else part, dimension)
        except UnitError:
            continue
    raise click.BadParameter(
        f"{part!r} is no current, resistance, inductance, torque, inertia, step angle or voltage with its unit, "
        f"like {EXAMPLE}", param_hint=_OPTION,
    )  # fmt: skip
