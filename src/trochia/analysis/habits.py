"""Mistakes that are legal programs: cutting with the spindle off, a beam on at rest, a rapid through the part.

In: a program and the machine's spindle and beam.  Out: a warning of each kind, at its first line, with how many more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity, more_lines
from trochia.program import AXES, Dwell, MoveKind, Pause, Spindle, SpindleLock, ToolChange, Unfinished

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.program import Program

_X, _Y, _Z = 0, 1, 2


def warnings(program: Program, machine: Machine) -> list[Problem]:
    """Return the warnings a program earns on a machine, in the order of their first lines."""
    tool = "beam" if machine.beam else "spindle"
    moves = program.moves
    moving = _moving(program)
    rapid = moves["kind"] == MoveKind.RAPID
    found: list[tuple[str, NDArray[np.bool_], str, str]] = []
    if machine.beam or machine.spindle:
        off = moving & ~rapid & (moves["power"] == 0)
        found.append(("tool-off", off, f"feed with the {tool} off", "Switch it on (M3 S…) before the cut."))
    if machine.beam:
        lit = moving & rapid & (moves["power"] > 0)
        found.append(("beam-in-rapid", lit, "the beam is on in a rapid", "Switch it off (M5) before G0."))
    if any(axis.name == "Z" for axis in machine.axes):
        low = _below_lowest_cut(program, moving, rapid)
        found.append(("rapid-below-cut", low, "a rapid runs below the lowest cut", "Lift Z before travelling."))
    problems = [
        _warn(program, code, moves["line"][mask], message, hint) for code, mask, message, hint in found if mask.any()
    ]
    problems += [
        _warn(
            program,
            "unfinished-code",
            np.array([action.line], dtype=np.uint32),
            f"{action.code}: {action.why}",
            "Write its moves out, or use G85, G86 or G89.",
        )
        for action in program.actions
        if isinstance(action, Unfinished)
    ]
    if machine.beam:
        lines = np.array(list(_lit_rests(program)), dtype=np.uint32)
        if lines.size:
            problems.append(
                _warn(program, "beam-at-rest", lines, "the beam is on at a standstill", "Switch it off (M5) first.")
            )
    return sorted(problems, key=lambda problem: problem.line)


def _changed(program: Program, columns: Sequence[int]) -> NDArray[np.bool_]:
    """Return which moves change any of these columns (moves,); one column at a time, a million moves are long."""
    changed = np.zeros(len(program.moves), dtype=np.bool_)
    for column in columns:
        end = program.moves["target"][:, column]
        changed[:1] |= end[:1] != program.start[column]
        changed[1:] |= end[1:] != end[:-1]
    return changed


def _moving(program: Program) -> NDArray[np.bool_]:
    """Return which moves go anywhere (moves,): a full circle or a loop does, though it ends where it began."""
    return _changed(program, range(len(AXES))) | (program.moves["kind"] >= MoveKind.ARC)


def _below_lowest_cut(program: Program, moving: NDArray[np.bool_], rapid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which rapids travel in X or Y deeper than any feed move ever is (moves,)."""
    end = program.moves["target"][:, _Z]
    depth = end.copy()
    depth[:1] = np.minimum(depth[:1], program.start[_Z])
    depth[1:] = np.minimum(end[1:], end[:-1])
    cuts = moving & ~rapid
    if not cuts.any():
        return cuts
    return rapid & _changed(program, (_X, _Y)) & (depth < depth[cuts].min())


def _lit_rests(program: Program) -> Iterable[int]:
    """Yield the lines on which the machine rests with the beam on."""
    lit = False
    for action in program.actions:
        if isinstance(action, Spindle):
            lit = action.direction != 0
        elif lit and (isinstance(action, ToolChange | Pause) or (isinstance(action, Dwell) and action.seconds > 0)):
            yield action.line


def locked_moves(program: Program) -> NDArray[np.intp]:
    """Return the rows of the moves that are locked to the spindle, rising."""
    turns = [(action.at, action.pitch) for action in program.actions if isinstance(action, SpindleLock)]
    ends = [at for at, _ in turns[1:]] + [len(program.moves)]
    spans = [np.arange(at, end) for (at, pitch), end in zip(turns, ends, strict=True) if pitch] if turns else []
    return np.concatenate([*spans, np.zeros(0, dtype=np.intp)]).astype(np.intp)


def _warn(program: Program, code: str, lines: NDArray[np.uint32], message: str, hint: str) -> Problem:
    """Return one warning for all lines of a kind."""
    more = more_lines(lines)
    return Problem(
        severity=Severity.WARNING, code=code, file=program.name, line=int(lines[0]), message=message + more, hint=hint
    )
