"""Variables that outlast a program, in LinuxCNC's ``.var`` format.

One variable a line, number and value, numbers rising: points of G28 and G30 (5161, 5181), the shift of G92 (5210 to
5219), the active system (5220), origins and rotations (5221 to 5390), and any other number for the program's own use.

In: text, and the length its lengths count in [mm].  Out: a :class:`~trochia.program.WorkState`, or the text again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.program.modes import AXES
from trochia.program.work import SYSTEMS, WorkState

if TYPE_CHECKING:
    from collections.abc import Mapping

LARGEST = 5601  #: greatest number of a variable
G28, G30, SHIFT_ON, SHIFT, ACTIVE, FIRST_SYSTEM = 5161, 5181, 5210, 5211, 5220, 5221
STEP, ROTATION = 20, 9  #: from one system's first variable to the next one's; from it to its rotation
_ROTARY = frozenset("ABC")
_HOW = "A line is a number from 1 to 5601 and a value, like: 5221 12.5"


def read_variables(text: str, name: str) -> dict[int, float]:
    """Return the variables of a file, {number: value}, as they stand there.

    Lines that do not begin with two numbers are remarks.

    Raises
    ------
    ConfigError
        For a number that no variable has, and where numbers do not rise.
    """
    found: dict[int, float] = {}
    last = 0
    for at, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        try:
            number, value = int(words[0]), float(words[1])
        except (IndexError, ValueError):
            continue
        if not 1 <= number <= LARGEST:
            raise ConfigError(f"{name}, line {at}: there is no variable {number}", hint=_HOW)
        if number <= last:
            raise ConfigError(f"{name}, line {at}: variable {number} stands behind {last}",
                              hint="Numbers must rise from line to line.")  # fmt: skip
        found[number] = value
        last = number
    return found


def work_from(variables: Mapping[int, float], work: WorkState | None = None, *, unit: float = 1.0) -> WorkState:
    """Return a work state with the offsets and points the variables tell; ``unit`` is their length [mm].

    A number of the active system that is no system counts as 1, as the reference has it.
    """
    active = round(variables.get(ACTIVE, 1.0))
    firsts = [FIRST_SYSTEM + STEP * system for system in range(len(SYSTEMS))]
    own = {number: value for number, value in variables.items() if not _is_offset(number)}
    return replace(
        work or WorkState(),
        systems=tuple(_point(variables, first, unit) for first in firsts),
        rotations=tuple(variables.get(first + ROTATION, 0.0) for first in firsts),
        active=active if 1 <= active <= len(SYSTEMS) else 1,
        g92=_point(variables, SHIFT, unit),
        g92_on=variables.get(SHIFT_ON, 0.0) != 0,
        g28=_point(variables, G28, unit),
        g30=_point(variables, G30, unit),
        variables=own,
    )


def variables_of(work: WorkState, *, unit: float = 1.0) -> dict[int, float]:
    """Return the variables of a work state, {number: value}; ``unit`` is their length [mm]."""
    found = dict(work.variables)
    found |= _spread(G28, work.g28, unit) | _spread(G30, work.g30, unit) | _spread(SHIFT, work.g92, unit)
    found |= {SHIFT_ON: float(work.g92_on), ACTIVE: float(work.active)}
    for system, (origin, turn) in enumerate(zip(work.systems, work.rotations, strict=True)):
        first = FIRST_SYSTEM + STEP * system
        found |= _spread(first, origin, unit)
        found[first + ROTATION] = turn
    return found


def write_variables(variables: Mapping[int, float]) -> str:
    """Return the text of a file, numbers rising."""
    return "".join(f"{number}\t{value:.6f}\n" for number, value in sorted(variables.items()))


def _is_offset(number: int) -> bool:
    """Return whether a variable is one of the work state's offsets and points."""
    if SHIFT_ON <= number < FIRST_SYSTEM:
        return True
    if FIRST_SYSTEM <= number < FIRST_SYSTEM + STEP * len(SYSTEMS):
        return (number - FIRST_SYSTEM) % STEP <= ROTATION
    return G28 <= number < G28 + len(AXES) or G30 <= number < G30 + len(AXES)


def _point(variables: Mapping[int, float], first: int, unit: float) -> tuple[float, ...]:
    """Return the point (9) [mm, degree] whose first variable is ``first``."""
    return tuple(
        variables.get(first + at, 0.0) * (1.0 if axis in _ROTARY else unit) for at, axis in enumerate(AXES)
    )  # fmt: skip


def _spread(first: int, point: tuple[float, ...], unit: float) -> dict[int, float]:
    return {
        first + at: value / (1.0 if axis in _ROTARY else unit)
        for at, (axis, value) in enumerate(zip(AXES, point, strict=True))
    }
