"""Whether a board can do what a plan asks: its motors, their steps, its processor, its line.

In: a plan and the board it is to run on.  Out: problems, each at the line where there is too much for the first time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.plan import make
from trochia.analysis.problems import Problem, Severity, from_error
from trochia.backends.avr.ahead import spans_ahead, spans_of
from trochia.backends.avr.busy import MOST_FEED, Fastest, Stretch, stretches
from trochia.backends.avr.load import Load, faster
from trochia.backends.avr.wiring import BOARDS
from trochia.errors import ConfigError, LimitError
from trochia.pulses.steps import CLOCK

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan
    from trochia.backends.avr.load import Excess

_TRIALS = 4  #: plans made to find how far the feed can be overridden
_NEAR = 0.02
MARGIN = 0.97  #: of the room that is found: a faster motion is cut into other segments
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


@dataclass(frozen=True, slots=True)
class Room:
    """How far the feed of a plan may be overridden on a board, 2 at most; below 1 with what is wrong at 100 %."""

    most: float
    problem: Problem | None = None


def room_on(plan: Plan, board: str, baud: int) -> Room:
    """Return how much a board can do of what a plan asks: as :func:`board_problems`, but only where it may be much.

    The steps of a faster feed ask at most in proportion more; what is due to rapids alone stays as it is.
    """
    fastest, most, wrong, behind = Fastest(), MOST_FEED, list[Problem](), 0.0
    try:
        for stretch in stretches(plan.trajectory, plan.machine, board, fastest):
            load = Load(board, baud)
            load.behind = behind if stretch.on else 0.0
            room = _room_in(plan, stretch, load, board, baud)
            behind = load.behind
            most = min(most, room.most)
            wrong += [] if room.problem is None else [room.problem]
    except ConfigError as error:
        return Room(0.0, from_error(error, plan.program.name))
    greatest = CLOCK / BOARDS[board].closest
    most = min(most, MARGIN * greatest / max(fastest.feed, 1.0))
    return Room(most if wrong else max(most, 1.0), wrong[0] if wrong else None)


def most_feed(plan: Plan, board: str, baud: int, least: float) -> float:
    """Return the greatest override of the feed, ``least`` or more, whose own plan a board can do."""
    low, high = least, MOST_FEED
    trial = high
    for _ in range(_TRIALS):
        if room_on(_faster(plan, trial), board, baud).problem is None:
            low = trial
        else:
            high = trial
        if high - low < _NEAR:
            break
        trial = 0.5 * (low + high)
    return low


def _faster(plan: Plan, factor: float) -> Plan:
    """Return the plan of the same program with every feed so many times as fast."""
    moves = plan.program.moves.copy()
    moves["rate"] *= factor
    return make(replace(plan.program, moves=moves), plan.machine)


def _room_in(plan: Plan, stretch: Stretch, load: Load, board: str, baud: int) -> Room:
    """Return the room in a stretch: what its rapids alone ask for stays as it is."""
    begin, at, behind, slots = round(float(stretch.times[0]) * CLOCK), 0, load.behind, 0.1
    edges = np.rint((stretch.times - stretch.times[0]) * CLOCK)
    spans: list[tuple[float, int, bool]] = []
    try:
        for span in spans_of([(stretch.times, True)], plan.trajectory, plan.machine, board):
            at = span.end
            first, last = (int(edges.searchsorted(tick, side)) for tick, side in ((span.start, "right"), (at, "left")))
            feed, one = bool(stretch.feed[max(first - 1, 0) : last].any()), load.add(span)
            spans.append((one.cycles, at - span.start, feed))
            slots = max(slots, one.slots if feed else 0.0)
    except LimitError as error:
        return Room(MOST_FEED, _of(plan, begin + at, error.message, error.hint or ""))
    wrong = [load.worst[kind] for kind in ("processor", "slots") if kind in load.worst]
    most = MARGIN * min(faster(spans, behind, MOST_FEED / MARGIN), 1.0 / slots)
    if wrong:
        worst = max(wrong, key=lambda one: one.part)
        return Room(most, _excess(plan, load, worst, board, baud, begin=begin))
    return Room(max(most, 1.0))


def _excess(plan: Plan, load: Load, worst: Excess, board: str, baud: int, *, begin: int = 0) -> Problem:
    """Return the problem of an excess: where it comes first, how much it is at worst."""
    first = load.first[worst.kind]
    motors = f"{worst.motors} motor{'s' if worst.motors > 1 else ''}"
    asked = f"{worst.rate:,.0f} steps/s of {motors} in {worst.spans:,.0f} tick segments a second {_WHAT[worst.kind]}"
    if worst.kind in {"processor", "slots"}:
        hint = (f"Lower the feed to {100.0 / worst.part:.0f} % there, take fewer microsteps, or make segments longer: "
                "join short ones (G64 P), round corners.")  # fmt: skip
        return _of(plan, begin + first.at, f"{board}: {asked}: {worst.part:.2f} of that", hint)
    faster = " take the image at 1,000,000 baud (--baud 1000000);" if worst.kind == "line" and baud < 1_000_000 else ""
    return _of(
        plan, begin + first.at, f"{board}: {asked}; it brakes along the path, the beam dark, until more has come",
        f"To keep the feed:{faster} lower it, or raise the axes' acceleration, so that less way is needed to stop.",
        code=STARVED, severity=Severity.WARNING,
    )  # fmt: skip


def _of(
    plan: Plan, tick: int, message: str, hint: str, *, code: str = TOO_MUCH, severity: Severity = Severity.ERROR
) -> Problem:
    """Return a problem at the line that is run at a tick."""
    line = int(plan.trajectory.line_at(np.array([tick / CLOCK]))[0])
    return Problem(severity=severity, code=code, file=plan.program.name, line=line, message=message, hint=hint)
