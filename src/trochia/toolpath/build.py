"""Programs to paths.  In: a Program and the machine's axes.  Out: a Toolpath, with blends inside the tolerances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError, PlanningError, Source
from trochia.kernels import path as kernel
from trochia.kernels import spline
from trochia.program import AXES, MoveKind, Plane, Spindle
from trochia.toolpath.toolpath import Toolpath

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.program import Program


_CURVED = 3  #: letters that arcs and splines move: X Y Z
SPLINE_ERROR = 1e-4  #: mm: how far a spline's cubics by length may lie from the curve


def build(
    program: Program, machine: Machine, *, blend: bool = True, continuity: int = 1, overlap: bool = True,
    room: kernel.Room | None = None, first_row: int = 0,
) -> Toolpath:  # fmt: skip
    """Return the path of a program on a machine.

    Parameters
    ----------
    program
        Moves of zero length leave nothing; before each action motion rests.
    machine
        Its axes are the path's columns, its ``path_tolerance`` holds where G64 gives no P.
    blend
        False gives the programmed path itself, which stops wherever direction jumps.
    continuity
        What is continuous where motion does not stop: 1, direction; 2, curvature too (``Profile.continuity`` says what
        a velocity profile needs).
    overlap
        With continuity 2: lone corners of lines are passed as overlaps of their moves, at whose ends curvature jumps,
        but along the path alone, so that acceleration need not.
    room
        Where the path is built, if it may be gone when the next one is built there.
    first_row
        Number of the program's first move, where it is a piece of another one.

    Raises
    ------
    PlanningError
        When the program moves an axis the machine does not have.
    LimitError
        When a feed has no speed: no F, or a feed per revolution with the spindle at rest.
    """
    columns = machine.columns
    absent = [column for column in range(len(AXES)) if column not in columns]
    if absent and absent[0] < _CURVED:  # curves may move it, and come back
        _refuse_absent(program, machine, absent)
    segments, pool, merged, fault = kernel.build(
        program.moves, rests_before(program, machine), start=program.start, columns=columns, absent=absent,
        tolerance=machine.path_tolerance if blend else -1.0, continuity=continuity, overlap=overlap,
        limits=_limits(machine), splines=_splines(program), room=room, first_row=first_row,
    )  # fmt: skip
    if fault and fault[0] == "axis":
        _refuse_absent(program, machine, absent)
    if fault and fault[0] == "spline":
        raise ValueError(f"move {fault[1]} follows a spline that is not there or does not lead to its target")
    if fault:
        raise _no_speed(program, *fault)
    letters = "".join(axis.name for axis in machine.axes)
    return Toolpath(axes=letters, start=program.start[list(columns)], segments=segments, pool=pool, merged=merged)


def _splines(program: Program) -> tuple[NDArray[np.void], NDArray[np.uint64], float] | None:
    """Return the program's splines as pieces by length, and their error; None where it has none."""
    return (*spline.fit(program.splines, SPLINE_ERROR), SPLINE_ERROR) if len(program.splines) else None


def _limits(machine: Machine) -> NDArray[np.float64]:
    """Return velocity, acceleration and jerk of each axis (3, n), infinite where there is none."""
    rows = [(a.velocity, a.acceleration, np.inf if a.jerk is None else a.jerk) for a in machine.axes]
    return np.array(rows, dtype=np.float64).T


def rests_before(program: Program, machine: Machine) -> NDArray[np.uint8]:
    """Return 1 for each move before which motion rests for an action (moves,).

    A beam is switched while the axes move; only a spindle needs time to start, stop and turn round.
    """
    beam = machine.spindle is None and machine.beam is not None
    rests = np.zeros(len(program.moves) + 1, dtype=np.uint8)
    rests[[
        action.at for action in program.actions if action.at_rest and not (beam and isinstance(action, Spindle))
    ]] = 1  # fmt: skip
    return rests[:-1]


def _refuse_absent(program: Program, machine: Machine, absent: list[int]) -> None:
    """Raise when a move needs an axis the machine lacks, naming the first such line."""
    moves = program.moves
    moved = moves["target"][:, absent] != program.start[absent]
    arcs = np.flatnonzero(moves["kind"] == MoveKind.ARC)
    for plane in Plane:
        lacking = [absent.index(column) for column in plane.axes if column in absent]
        flat = arcs[moves["plane"][arcs] == plane]
        moved[flat[:, None], lacking] = True
    curves = np.flatnonzero(moves["kind"] == MoveKind.SPLINE)
    for column in range(_CURVED):
        if column in absent and curves.size:
            bent = np.ptp(program.splines[moves["turns"][curves], :, column], axis=1) > 0.0
            moved[curves[bent], absent.index(column)] = True
    rows = np.flatnonzero(moved.any(axis=1))
    if rows.size:
        row = int(rows[0])
        letter = AXES[absent[int(np.flatnonzero(moved[row])[0])]]
        raise PlanningError(
            f"the move needs axis {letter}, which machine {machine.name!r} does not have",
            source=Source(program.name, int(moves["line"][row])),
            hint="Its axes are " + " ".join(axis.name for axis in machine.axes) + ".",
        )


def _no_speed(program: Program, fault: str, row: int) -> LimitError:
    """Return the error for a move without speed."""
    source = Source(program.name, int(program.moves["line"][row]))
    if fault == "spindle":
        return LimitError("a feed per revolution needs a turning spindle", source=source,
                          hint="Start it with S… M3 before this line, or use G94.")  # fmt: skip
    return LimitError("the move has no feed", source=source, hint="Give F… on this line or before it.")
