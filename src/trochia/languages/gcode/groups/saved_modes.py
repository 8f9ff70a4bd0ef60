"""M70 to M73: keep the modes, and bring them back.

In: the state.  Out: the codes that lead back, run as a line of their own, so that they print and act as written ones.

Every call of a subroutine has a place of its own for the modes it keeps: :func:`enter` and :func:`leave` are for
whoever makes the calls.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from trochia.errors import ModalConflictError, ProgramError
from trochia.languages.gcode.codes import Code, table
from trochia.program.modes import PathMode, Plane, TimeLaw
from trochia.program.work import SYSTEMS

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_LAWS = {TimeLaw.PER_SECOND: "G94", TimeLaw.PER_REV: "G95", TimeLaw.INVERSE: "G93"}
_PLANES = {Plane.XY: "G17", Plane.ZX: "G18", Plane.YZ: "G19"}
_EXACT = {PathMode.EXACT_PATH: "G61", PathMode.EXACT_STOP: "G61.1"}
_TURNS = {0: "M5", 1: "M3", -1: "M4"}


class Modes(NamedTuple):
    """What M70 keeps: codes by what they decide, in the order in which they are brought back."""

    units: str
    codes: tuple[str, ...]
    coolant: tuple[str, str]
    overrides: tuple[str, ...]
    at_return: bool  #: M73: bring them back when the call returns


def keep(block: Block, state: State, sink: Sink) -> None:
    """M70: keep the modes."""
    del block, sink
    state.saved[-1] = _modes_of(state, at_return=False)


def forget(block: Block, state: State, sink: Sink) -> None:
    """M71: forget what M70 or M73 kept."""
    del block, sink
    state.saved[-1] = None


def bring_back(block: Block, state: State, sink: Sink) -> None:
    """M72: bring back what M70 kept; nothing else on the line acts any more."""
    kept = state.saved[-1]
    if kept is None:
        raise block.fault(ModalConflictError, "M72 has no modes to bring back", "M72",
                          hint="Keep them before by M70, at the same level of calls.")  # fmt: skip
    _restore(kept, block.place, state, sink)
    block.dropped = True


def keep_for_return(block: Block, state: State, sink: Sink) -> None:
    """M73: keep the modes, and bring them back when the subroutine returns."""
    del block, sink
    state.saved[-1] = _modes_of(state, at_return=True)


def enter(state: State) -> None:
    """Begin a call: it keeps modes of its own."""
    state.saved.append(None)


def leave(state: State, sink: Sink, place: Place) -> None:
    """End a call: after M73 its modes come back.  ``place`` is the line that returns; errors are those of M72."""
    kept = state.saved.pop() if len(state.saved) > 1 else None
    if kept is not None and kept.at_return:
        _restore(kept, place, state, sink)


def _modes_of(state: State, *, at_return: bool) -> Modes:
    """Return the modes in force, as codes."""
    path = _EXACT.get(state.path_mode)
    if path is None:
        blend = f"P{_text(state.tolerance)}" if state.path_mode == PathMode.BLEND else ""
        path = f"G64{blend}Q{_text(state.tolerance_along)}"
    codes = (
        "G96" if state.surface_speed else "G97",
        _LAWS[state.law],
        f"F{_text(state.feed)}",
        f"S{_text(state.speed)}",
        _TURNS[state.direction],
        _PLANES[state.plane],
        "G40" if state.compensation is None else "G41" if state.compensation.side > 0 else "G42",
        "G43" if any(state.tool_offset) else "G49",
        SYSTEMS[state.system - 1],
        path,
        "G90" if state.absolute else "G91",
        "G90.1" if state.arc_absolute else "G91.1",
        "G92.3" if state.shift_on else "G92.2",
    )
    overrides = (
        f"M50 P{state.feed_override:d}",
        f"M51 P{state.speed_override:d}",
        f"M52 P{state.adaptive_feed:d}",
        f"M53 P{state.feed_hold:d}",
    )
    # as the reference has it: mist is switched off only where flood is off too
    coolant = ("M7" if state.mist else "" if state.flood else "M9", "M8" if state.flood else "")
    return Modes("G20" if state.inch else "G21", codes, coolant, overrides, at_return)


def _text(value: float) -> str:
    """Return a number as the language writes it."""
    return f"{value:.17f}".rstrip("0").rstrip(".")


def _restore(kept: Modes, place: Place, state: State, sink: Sink) -> None:
    """Run the codes by which the modes in force differ from the kept ones."""
    lines: list[str] = []
    now = _modes_of(state, at_return=False)
    if kept.units != now.units:
        lines.append(kept.units)
    lines.append(" ".join(old for old, new in zip(kept.codes, now.codes, strict=True) if old != new))
    lines += [old for old, new in zip(kept.coolant, now.coolant, strict=True) if old != new]
    lines += [old for old, new in zip(kept.overrides, now.overrides, strict=True) if old != new]
    for line in filter(None, lines):
        _run(line, place, state, sink)


def _run(line: str, place: Place, state: State, sink: Sink) -> None:
    """Run a line that is not in the text.

    Raises
    ------
    ModalConflictError
        At ``place``, where it cannot run.
    """
    from trochia.languages.gcode.execution import run_line  # noqa: PLC0415 - it needs the table of codes

    try:
        run_line(line, place, state, sink)
    except ProgramError as error:
        raise place.fault(ModalConflictError, f"the kept modes cannot be brought back by {line}: {error.message}",
                          hint=error.hint) from error  # fmt: skip


_GROUP, _STEP = "spindle", "saved modes"  # the reference has one group for both
M_CODES = table(
    Code(name="M70", about="keep the modes", group=_GROUP, step=_STEP, run=keep),
    Code(name="M71", about="forget the kept modes", group=_GROUP, step=_STEP, run=forget),
    Code(name="M72", about="bring the kept modes back", group=_GROUP, step=_STEP, run=bring_back),
    Code(name="M73", about="keep the modes until the subroutine returns", group=_GROUP, step=_STEP,
         run=keep_for_return),
)  # fmt: skip
