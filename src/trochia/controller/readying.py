"""From text to a plan that starts where the machine is.

In: G-code, the machine, its work state, where it stands.  Out: a plan, held to the travel, and the work state the text
leaves behind.  The last one is kept: what was checked at loading runs at once if nothing has changed since.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.plan import Plan, make
from trochia.analysis.travel import travel_error
from trochia.errors import TrochiaError
from trochia.languages import gcode
from trochia.languages.gcode.answers import KEPT, Answer, Answers
from trochia.program import AXES, Action, PathMode, Probe, Program, WaitInput, WorkState

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine

MDI = "<mdi>"  #: name of lines that are no program
EXACT = PathMode.EXACT_STOP
ASKING = Probe | WaitInput  #: actions whose outcome decides how a program goes on


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """A plan, what it was made from, and what it leaves behind.

    ``start`` is where the machine stood (9,), ``found`` what was set up, ``work`` what the text leaves set up.

    Attributes
    ----------
    answers
        What the machine had answered to the program's questions; None: it was read as if nobody answered.
    asks
        The question at which the program was read no further; None: it comes to its end.
    moves, actions
        How many the whole text has so far; the plan may be of the last of them only.
    """

    plan: Plan
    text: str
    name: str
    key: tuple[object, ...]
    work: WorkState
    found: WorkState
    start: tuple[float, ...]
    block_delete: bool = False
    answers: tuple[Answer, ...] | None = None
    asks: Action | None = None
    moves: int = 0
    actions: int = 0

    @property
    def asking(self) -> bool:
        """Whether what follows depends on the machine's answers, and they were not asked for."""
        return self.answers is None and any(isinstance(act, ASKING) for act in self.plan.program.actions)


class Readier:
    """Readies programs for one machine.

    Parameters
    ----------
    reading
        How programs are read; in the machine's dialect where nothing else is said.
    """

    def __init__(self, machine: Machine, reading: gcode.Reading | None = None) -> None:
        reading = reading or gcode.Reading()
        self._machine = machine
        self._reading = replace(reading, dialect=reading.dialect or gcode.DIALECTS[machine.dialect])
        self._last: Ready | None = None
        self._failed: tuple[tuple[object, ...], TrochiaError] | None = None  # what was found wrong beside the turns

    def knows(
        self, text: str, name: str, *, work: WorkState, at: dict[str, float], block_delete: bool, exact: bool
    ) -> bool:
        """Whether the plan of a text is there."""
        key = _key(text, name, work, _start(at), block_delete=block_delete, exact=exact, answers=None)
        return self._last is not None and self._last.key == key

    def prepare(
        self, text: str, name: str, *, work: WorkState, at: dict[str, float], block_delete: bool, exact: bool,
        bounded: bool,
    ) -> bool:  # fmt: skip
        """Have the plan of a text, or what is wrong with it, ready for the next call of :meth:`ready`; True: a plan."""
        try:
            self.ready(text, name, work=work, at=at, block_delete=block_delete, exact=exact, bounded=bounded)
        except TrochiaError as error:
            key = _key(text, name, work, _start(at), block_delete=block_delete, exact=exact, answers=None)
            self._failed = (key, error)
            return False
        return True

    def ready(
        self, text: str, name: str, *, work: WorkState, at: dict[str, float], block_delete: bool = False,
        exact: bool = False, bounded: bool = True, ours: bool = False, answers: tuple[Answer, ...] | None = None,
    ) -> Ready:  # fmt: skip
        """Return the plan of a text that begins at machine positions ``at`` [mm, degree].

        Parameters
        ----------
        exact
            Whether motion rests at the end of every move, as it does block by block.
        bounded
            Whether the travel binds: it does not where nobody knows the position, nor where the machine is to answer.
        ours
            Whether the text is the controller's own, in LinuxCNC's language.
        answers
            Of the machine, to the first questions; the text is read to the next.  None: as if nobody answered.

        Raises
        ------
        ProgramError, PlanningError
            At the first thing that is wrong.
        """
        start = _start(at)
        key = _key(text, name, work, start, block_delete=block_delete, exact=exact, answers=answers)
        last, (failed, self._failed) = self._last, (self._failed, None)
        if last is not None and last.key == key:
            return last
        if failed is not None and failed[0] == key:
            raise failed[1]
        program, left, asks = self._read(text, name, work, start, block_delete=block_delete, answers=answers,
                                         ours=ours)  # fmt: skip
        plan = make(_stopping(program) if exact else program, self._machine)
        made = Ready(plan=plan, text=text, name=name, key=key, work=left, found=work, start=start, answers=answers,
                     block_delete=block_delete, asks=asks, moves=len(program.moves),
                     actions=len(program.actions))  # fmt: skip
        error = travel_error(plan) if bounded and not made.asking else None
        if error is not None:
            raise error
        if not name.startswith("<"):  # a jog, or a line of the operator's, does not take the program's place
            self._last = made
        return made

    def onward(self, made: Ready, answer: Answer, *, at: dict[str, float], exact: bool) -> Ready:
        """Return the plan of what a program does after a question, up to its next one or its end, from ``at``.

        Raises
        ------
        ProgramError, PlanningError
            As :meth:`ready`.
        """
        answers = (*(made.answers or ()), answer)
        whole, left, asks = self._read(made.text, made.name, made.found, made.start, block_delete=made.block_delete,
                                       answers=answers)  # fmt: skip
        rest = rest_of(whole, made.moves, made.actions, np.array([at.get(letter, 0.0) for letter in AXES]))
        plan = make(_stopping(rest) if exact else rest, self._machine)
        error = travel_error(plan)
        if error is not None:
            raise error
        return replace(made, plan=plan, work=left, answers=answers, asks=asks, moves=len(whole.moves),
                       actions=len(whole.actions))  # fmt: skip

    def _read(
        self, text: str, name: str, work: WorkState, start: tuple[float, ...], *, block_delete: bool,
        answers: tuple[Answer, ...] | None, ours: bool = False,
    ) -> tuple[Program, WorkState, Action | None]:  # fmt: skip
        """Return a text as a program, what it leaves set up, and the question it was read to."""
        given = None if answers is None else Answers(answers)
        found = replace(work, variables={**dict.fromkeys(KEPT, 0.0), **work.variables}) if answers else work
        left: list[WorkState] = []
        base = gcode.Reading() if ours else self._reading
        reading = replace(base, work=found, on_end=left.append, answers=given)
        program = gcode.read(text, name=name, work=found, start=start, block_delete=block_delete, reading=reading)
        asks = program.actions[-1] if given is not None and given.wanting else None
        return program, left[-1] if left else work, asks

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


def _start(at: dict[str, float]) -> tuple[float, ...]:
    return tuple(at.get(letter, 0.0) for letter in AXES)


def _key(
    text: str, name: str, work: WorkState, start: tuple[float, ...], *, block_delete: bool, exact: bool,
    answers: tuple[Answer, ...] | None,
) -> tuple[object, ...]:  # fmt: skip
    """Return what a plan depends on."""
    return (text, name, id(work), tuple(round(value, 6) for value in start), block_delete, exact, answers)


def rest_of(program: Program, moves: int, actions: int, start: NDArray[np.float64]) -> Program:
    """Return what follows the first moves and actions of a program, from where the machine stands (9,)."""
    later = tuple(replace(act, at=act.at - moves) for act in program.actions[actions:])
    return replace(program, start=start, moves=program.moves[moves:], actions=later)


def _stopping(program: Program) -> Program:
    """Return the program with an exact stop at the end of every move."""
    moves = program.moves.copy()
    moves["path_mode"] = EXACT.value
    return replace(program, start=program.start.copy(), moves=moves)
