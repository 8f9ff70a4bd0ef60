"""A machine file from a few answers.  In: axis letters, a kinematics, values by dotted key.  Out: a document.

Every answer that is not given has a sensible value, so that a first machine loads; the written file explains each key.
"""

from __future__ import annotations

import tomllib
from decimal import Decimal
from typing import TYPE_CHECKING, Any, cast

from trochia.errors import ConfigError
from trochia.machine.axes import LETTERS
from trochia.machine.read import FORMAT, read
from trochia.units import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable

    from trochia.errors import MachineError
    from trochia.machine.machine import Machine

Document = dict[str, Any]

#: limits of a usual small machine, by kind of axis
LINEAR = {"minimum": "0 mm", "maximum": "300 mm", "velocity": "100 mm/s", "acceleration": "500 mm/s²"}
ROTARY = {"minimum": "-3600 deg", "maximum": "3600 deg", "velocity": "60 deg/s", "acceleration": "360 deg/s²"}
Z = {"minimum": "-100 mm", "maximum": "0 mm", "velocity": "40 mm/s", "acceleration": "300 mm/s²"}


def letters_of(text: str) -> tuple[str, ...]:
    """Return axis letters, each once, in the machine's order.

    Raises
    ------
    ConfigError
        For another letter, one that stands twice, or none.
    """
    letters = [letter for letter in text.upper() if letter not in " ,"]
    for letter in letters:
        if letter not in LETTERS:
            raise ConfigError(f"expected letters out of {LETTERS}, like XYZ, not {letter!r}", key="axes")
    if not letters or len(set(letters)) != len(letters):
        raise ConfigError(f"expected letters, each once, like XYZ, not {text!r}", key="axes")
    return tuple(sorted(letters, key=LETTERS.index))


def draft(name: str, kinematics: str, letters: Iterable[str]) -> Document:
    """Return the document of a machine with these axes and a stepper for each."""
    axes = {letter: _axis(letter) for letter in letters}
    names = {"X": "belt-a", "Y": "belt-b"} if kinematics == "corexy" else {}
    joints: Document = {names.get(letter, letter): _joint(letter, kinematics) for letter in axes}
    return {"format": FORMAT, "name": name, "kinematics": kinematics, "axes": axes, "joints": joints}


def _axis(letter: str) -> dict[str, str]:
    """Return the limits of one axis."""
    return dict(ROTARY if letter in "ABC" else Z if letter == "Z" else LINEAR)


def _joint(letter: str, kinematics: str) -> Document:
    """Return a stepper with a usual transmission."""
    motor = {"kind": "stepper", "full_steps": 200, "microsteps": 8}
    if letter in "ABC":
        return {"motor": motor, "transmission": {"kind": "direct", "ratio": 10}}
    if kinematics == "corexy" and letter in "XY":
        return {"motor": motor, "transmission": {"kind": "belt", "pitch": "2 mm", "teeth": 20}}
    return {"motor": motor, "transmission": {"kind": "leadscrew", "lead": "5 mm"}}


def put(document: Document, key: str, text: str) -> None:
    """Set a value by its dotted key; the text is a TOML value, or a bare text as typed.

    ``put(d, "axes.X.velocity", "300 mm/s")`` and ``put(d, "joints.X.motor.microsteps", "16")``.

    Raises
    ------
    ConfigError
        When a table is in the way, or the key has no name.
    """
    *tables, last = key.split(".")
    if not last or not all(tables):
        raise ConfigError("expected a dotted key, like axes.X.velocity", key=key)
    here: Document = document
    for name in tables:
        inner = here.setdefault(name, {})
        if not isinstance(inner, dict):
            raise ConfigError(f"{name} is a value, not a table", key=key, hint=did_you_mean(name, document))
        here = cast("Document", inner)
    here[last] = value_of(text)


def value_of(text: str) -> Any:  # noqa: ANN401 - whatever TOML holds
    """Return a TOML value (number, flag, table, quoted text), or the text itself where it is none."""
    try:
        return tomllib.loads(f"value = {text}", parse_float=Decimal)["value"]
    except tomllib.TOMLDecodeError:
        return text


def machine_of(document: Document, file: str) -> tuple[Machine | None, list[MachineError]]:
    """Return the machine, or None and every mistake."""
    return read(document, file)
