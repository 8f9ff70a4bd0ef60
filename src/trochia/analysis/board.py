"""Whether a board can do what a plan asks: its motors, their steps, its processor, its line.

In: a plan and the board it is to run on.  Out: problems, each at the line where there is too much for the first time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity, from_error
from trochia.backends.avr.ahead import spans_ahead
from trochia.backends.avr.load import Load
from trochia.errors import ConfigError, LimitError
from trochia.pulses.steps import CLOCK

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan
    from trochia.backends.avr.load import Excess

TOO_MUCH = "board-overload"  #: the board would miss steps' times, and stop
STARVED = "board-starved"  #: the board would slow down by itself

_WHAT = {
    "processor": "are more than its processor can do",
    "slots": "are more than it can give one motor beside others: 125,000 a second",
    "line": "come slower over the line than they are run through",
    "queue": "are shorter than its queue must hold to be able to stop",
}


def board_problems(plan: Plan, board: str, baud: int) -> list[Problem]:
    """Return errors where a board cannot run a plan at 100 % feed, and warnings where it would slow down by itself."""
    load = Load(board, baud)
    try:
        at = 0
        try:
            for span in spans_ahead(plan.trajectory, plan.machine, board):
                at = span.end
                load.add(span)
        except LimitError as error:
            return [_of(plan, at, error.message, error.hint or "")]
    except ConfigError as error:
        return [from_error(error, plan.program.name)]
    wrong = [load.worst[kind] for kind in ("processor", "slots") if kind in load.worst]
    if wrong:
        return [_excess(plan, load, max(wrong, key=lambda one: one.part), board, baud)]
    slow = [load.worst[kind] for kind in ("line", "queue") if kind in load.worst]
    return [_excess(plan, load, max(slow, key=lambda one: one.part), board, baud)] if slow else []


def _excess(plan: Plan, load: Load, worst: Excess, board: str, baud: int) -> Problem:
    """Return the problem of an excess: where it comes first, how much it is at worst."""
    first = load.first[worst.kind]
    motors = f"{worst.motors} motor{'s' if worst.motors > 1 else ''}"
    asked = f"{worst.rate:,.0f} steps/s of {motors} in {worst.spans:,.0f} tick segments a second {_WHAT[worst.kind]}"
    if worst.kind in {"processor", "slots"}:
        hint = (f"Lower the feed to {100.0 / worst.part:.0f} % there, take fewer microsteps, or make segments longer: "
                "join short ones (G64 P), round corners.")  # fmt: skip
        return _of(plan, first.at, f"{board}: {asked}: {worst.part:.2f} of that", hint)
    faster = " take the image at 1,000,000 baud (--baud 1000000);" if worst.kind == "line" and baud < 1_000_000 else ""
    return _of(
        plan, first.at, f"{board}: {asked}; it brakes along the path, the beam dark, until more has come",
        f"To keep the feed:{faster} lower it, or raise the axes' acceleration, so that less way is needed to stop.",
        code=STARVED, severity=Severity.WARNING,
    )  # fmt: skip


def _of(
    plan: Plan, tick: int, message: str, hint: str, *, code: str = TOO_MUCH, severity: Severity = Severity.ERROR
) -> Problem:
    """Return a problem at the line that is run at a tick."""
    line = int(plan.trajectory.line_at(np.array([tick / CLOCK]))[0])
    return Problem(severity=severity, code=code, file=plan.program.name, line=line, message=message, hint=hint)
