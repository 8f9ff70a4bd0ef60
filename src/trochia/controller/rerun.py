"""Beginning inside a program.

In: the whole program as it was read, which move to begin with, where the machine stands.  Out: a program that gets
there and goes on.  Moves are in machine coordinates already, so what was modal before is in them; what actions have
set up by then (tool, spindle, coolant, outputs) is set up again on the way.  The way is: Z up to the highest Z of the
program, then all other axes, then down; a machine without Z goes straight there, its beam dark.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LocalProtocolError
from trochia.program import (
    AXES,
    Action,
    Coolant,
    MoveKind,
    Output,
    PathMode,
    Program,
    Spindle,
    SynchronisedOutput,
    TimeLaw,
    ToolChange,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine

Z = AXES.index("Z")
DOWN = 5.0  #: speed of the way down where the program's own feed does not say [mm/s]
SAME = 1e-6  #: places that near are the same [mm or degree]


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A program that begins inside another.

    Attributes
    ----------
    program
        The way to get there, then the rest.
    move
        Number of the other's move it goes on with, and ``way`` how many moves lead there.
    place
        Where that is (9,) [mm, degree].
    told
        The way in words.
    """

    program: Program
    move: int
    way: int
    place: NDArray[np.float64]
    told: str

    def original(self, move: int) -> int:
        """Return the number that a move of this program has in the other."""
        return max(move - self.way, 0) + self.move


def move_of_line(program: Program, line: int) -> int:
    """Return the number of the first move of a source line.

    Raises
    ------
    LocalProtocolError
        When nothing moves in that line.
    """
    lines = program.moves["line"]
    found = np.flatnonzero(lines == line)
    if len(found):
        return int(found[0])
    later = lines[lines > line]
    hint = f"The next line that moves is {int(later.min())}." if len(later) else "Nothing moves after it either."
    raise LocalProtocolError(f"nothing moves in line {line}", hint=hint)


def entry(
    program: Program, move: int, machine: Machine, *, at: NDArray[np.float64], tool: int,
    place: NDArray[np.float64] | None = None,
) -> Entry:  # fmt: skip
    """Return the program that goes from ``at`` (9,) to the beginning of a move, or a place in it, and on.

    Parameters
    ----------
    tool
        In the spindle now.
    place
        Where in the move (9,); None: where it begins.
    """
    begin = program.starts()[move] if place is None else place
    way = _way(program, move, machine, at, begin)
    before = [action for action in program.actions if action.at < move + (place is not None)]
    later = [replace(a, at=a.at - move + len(way)) for a in program.actions if a.at >= move + (place is not None)]
    set_up = _set_up(before, tool, max(len(way) - 1, 0))
    moves = np.concatenate([way, program.moves[move:]])
    made = replace(program, start=at.copy(), moves=moves, actions=(*set_up, *later))
    words = [f"line {int(program.moves['line'][move])}"]
    words += [" ".join(_words(machine, a, b)) for a, b in zip([at, *way["target"]], way["target"], strict=False)]
    words += [f"tool {a.tool}" for a in set_up if isinstance(a, ToolChange)]
    words += [f"spindle {a.direction * a.speed:g} rpm" for a in set_up if isinstance(a, Spindle) and a.direction]
    return Entry(program=made, move=move, way=len(way), place=begin, told=", then ".join(words))


def _words(machine: Machine, before: NDArray[np.float64], after: NDArray[np.float64]) -> list[str]:
    """Return the axis words of a straight move."""
    columns = [AXES.index(axis.name) for axis in machine.axes]
    return [f"{AXES[i]}{after[i]:.3f}" for i in columns if abs(after[i] - before[i]) > SAME]


def _way(
    program: Program, move: int, machine: Machine, at: NDArray[np.float64], begin: NDArray[np.float64]
) -> NDArray[np.void]:
    """Return the moves from a place to another, exact stops, dark."""
    points = [begin]
    top = next((axis.maximum for axis in machine.axes if axis.name == "Z"), None)
    if top is not None:
        height = min(max(float(program.moves["target"][:, Z].max()), begin[Z], at[Z]), top)
        up, over = at.copy(), begin.copy()
        up[Z] = over[Z] = max(height, at[Z])
        points = [up, over, begin]
    rows = [point for i, point in enumerate(points) if np.abs(point - [at, *points][i]).max() > SAME]
    way = np.zeros(len(rows), program.moves.dtype)
    way["line"], way["path_mode"] = program.moves["line"][move], PathMode.EXACT_STOP
    way["kind"] = MoveKind.RAPID
    for i, point in enumerate(rows):
        way["target"][i] = point
    own = program.moves[move]
    if rows and top is not None and own["kind"] != MoveKind.RAPID and rows[-1] is begin:
        way["kind"][-1], way["law"][-1] = MoveKind.FEED, TimeLaw.PER_SECOND
        way["rate"][-1] = own["rate"] if own["law"] == TimeLaw.PER_SECOND and own["rate"] > 0.0 else DOWN
    return way


def _set_up(before: list[Action], tool: int, down: int) -> list[Action]:
    """Return what actions have left set up: the tool first, the rest before the way down (move ``down``)."""
    last: dict[object, Action] = {}
    for action in before:
        match action:
            case ToolChange() | Spindle() | Coolant():
                last[type(action)] = action
            case Output(index=index, value=value) | SynchronisedOutput(index=index, value=value):
                last[index, isinstance(value, bool)] = action
            case _:
                pass
    change = last.pop(ToolChange, None)
    first = [replace(change, at=0)] if isinstance(change, ToolChange) and change.tool != tool else []
    return [*first, *(replace(action, at=down) for action in last.values())]
