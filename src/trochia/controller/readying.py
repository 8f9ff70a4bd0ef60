"""From text to a plan that starts where the machine is.

In: G-code, the machine, its work state, where it stands.  Out: a plan, held to the travel, and the work state the text
leaves behind.  The last one is kept: what was checked at loading runs at once if nothing has changed since.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from trochia.analysis.plan import Plan, make
from trochia.analysis.travel import travel_error
from trochia.languages import gcode
from trochia.program import AXES, PathMode, Program, WorkState

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

MDI = "<mdi>"  #: name of lines that are no program
EXACT = PathMode.EXACT_STOP


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """A plan, what it was made from, and what it leaves behind.

    ``start`` is where the machine stood (9,), ``found`` what was set up, ``work`` what the text leaves set up.
    """

    plan: Plan
    text: str
    name: str
    key: tuple[object, ...]
    work: WorkState
    found: WorkState
    start: tuple[float, ...]


class Readier:
    """Readies programs for one machine."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._last: Ready | None = None

    def ready(
        self, text: str, name: str, *, work: WorkState, at: dict[str, float], block_delete: bool = False,
        exact: bool = False, bounded: bool = True,
    ) -> Ready:  # fmt: skip
        """Return the plan of a text that begins at machine positions ``at`` [mm, degree].

        Parameters
        ----------
        exact
            Whether motion rests at the end of every move, as it does block by block.
        bounded
            Whether the travel binds: it does not where nobody knows the position.

        Raises
        ------
        ProgramError, PlanningError
            At the first thing that is wrong.
        """
        start = tuple(at.get(letter, 0.0) for letter in AXES)
        key = (text, name, id(work), tuple(round(value, 6) for value in start), block_delete, exact)
        if self._last is not None and self._last.key == key:
            return self._last
        left: list[WorkState] = []
        reading = gcode.Reading(work=work, on_end=left.append)
        program = gcode.read(text, name=name, work=work, start=start, block_delete=block_delete, reading=reading)
        plan = make(_stopping(program) if exact else program, self._machine)
        error = travel_error(plan) if bounded else None
        if error is not None:
            raise error
        self._last = Ready(plan=plan, text=text, name=name, key=key, work=left[-1] if left else work,
                           found=work, start=start)  # fmt: skip
        return self._last

    def inside(self, made: Ready, program: Program, *, exact: bool) -> Ready:
        """Return the plan of a program that begins inside that of another (:mod:`trochia.controller.rerun`).

        Raises
        ------
        PlanningError
            As :meth:`ready`.
        """
        plan = make(_stopping(program) if exact else program, self._machine)
        error = travel_error(plan)
        if error is not None:
            raise error
        return replace(made, plan=plan)


def _stopping(program: Program) -> Program:
    """Return the program with an exact stop at the end of every move."""
    moves = program.moves.copy()
    moves["path_mode"] = EXACT.value
    return replace(program, start=program.start.copy(), moves=moves)
