"""A board's settings against a machine file.  In: ``$`` settings as read.  Out: a machine, or what differs."""

from __future__ import annotations

from math import isclose
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.importers.grbl import read as import_settings
from trochia.machine.read import FORMAT
from trochia.machine.read import read as read_machine

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.machine.machine import Machine


def answer_of(settings: Mapping[str, str]) -> str:
    """Return settings as ``$$`` shows them."""
    return "".join(f"{name}={value}\n" for name, value in settings.items() if name[1:].isdigit())


def machine_of(settings: Mapping[str, str], name: str = "grbl-board") -> Machine:
    """Return the machine that a board's settings tell of, as ``trochia machine import`` makes it.

    Raises
    ------
    ConfigError
        When they tell of none.
    """
    document = {"format": FORMAT, "name": name, **import_settings(answer_of(settings), "the board").document}
    machine, problems = read_machine(document, "the board")
    if machine is None:
        raise problems[0] if problems else ConfigError("the board's settings make no machine")
    return machine


def differences(machine: Machine, settings: Mapping[str, str]) -> list[str]:
    """Return in what a machine file promises more than the board's settings allow, a sentence each."""
    board = {axis.name: axis for axis in machine_of(settings).axes}
    found: list[str] = []
    for axis in machine.axes:
        other = board.get(axis.name)
        if other is None:
            found.append(f"the board has no axis {axis.name}")
            continue
        for what, mine, its, unit in (
            ("velocity", axis.velocity, other.velocity, "mm/s"),
            ("acceleration", axis.acceleration, other.acceleration, "mm/s²"),
            ("travel", axis.maximum - axis.minimum, other.maximum - other.minimum, "mm"),
        ):
            if mine > its and not isclose(mine, its, rel_tol=1e-6):
                found.append(f"{axis.name}: {what} is {mine:g} {unit} in the machine file, {its:g} on the board")
    return found
