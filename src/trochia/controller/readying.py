"""From text to a plan that starts where the machine is.

In: G-code, the machine, its work state, where it stands.  Out: a plan, held to the travel, and the work state the text
leaves behind.  The last one is kept: what was checked at loading runs at once if nothing has changed since.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.board import most_feed, room_on
from trochia.analysis.plan import Plan, make
from trochia.analysis.travel import travel_error
from trochia.backends.avr.busy import MOST_FEED
from trochia.errors import LimitError, Source, TrochiaError
from trochia.languages import gcode
from trochia.languages.gcode.answers import KEPT, Answer, Answers
from trochia.program import AXES, Action, PathMode, Probe, Program, WaitInput, WorkState

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine

MDI = "<mdi>"  #: name of lines that are no program
EXACT = PathMode.EXACT_STOP
_SHORT = 2000  #: moves of a program that is planned with other feeds, too: what bounds the others is less
_TRIES = 4  #: to find a speed that a board can do
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
    most
        Greatest override of the feed that the backend can do; below 1 for motion of the controller's own alone.
    slowed
        Share of the speed asked for at which motion of the controller's own goes.
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
    most: float = MOST_FEED
    slowed: float = 1.0

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
    bound
        The board that is to do it, and its baud rate; None: whoever moves can do what the machine can.
    """

    def __init__(
        self, machine: Machine, reading: gcode.Reading | None = None, bound: tuple[str, int] | None = None
    ) -> None:
        self.bound = bound
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
        if self.bound is not None:
            made = replace(made, most=self._room(plan, ours=ours))
        if not name.startswith("<"):  # a jog, or a line of the operator's, does not take the program's place
            self._last = made
        return made

    def straight(self, words: str, feed: float, name: str, *, at: dict[str, float]) -> Ready:
        """Return the plan of a straight move to machine positions, without offsets; slower where the board needs it.

        ``words`` are all but the value of F.
        """

        def at_share(share: float) -> Ready:
            text = f"G21 G90 G53 {words}{share * feed:.9f}\nM2\n"
            return self.ready(text, name, work=WorkState(), at=at, bounded=False, ours=True)

        slowed, made = 1.0, at_share(1.0)
        for _ in range(_TRIES):
            if made.most >= 1.0:
                break
            slowed *= made.most
            made = at_share(slowed)
        return replace(made, slowed=slowed)

    def _room(self, plan: Plan, *, ours: bool) -> float:
        """Return the greatest override of the feed that the board can do; refuse a program it cannot do at all."""
        assert self.bound is not None, "there is a board"
        room = room_on(plan, *self.bound)
        if room.problem is not None and not ours:
            raise LimitError(room.problem.message, hint=room.problem.hint,
                             source=Source(room.problem.file, room.problem.line))  # fmt: skip
        short = not ours and len(plan.program.moves) <= _SHORT
        return most_feed(plan, *self.bound, room.most) if short and room.most < MOST_FEED else room.most

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
