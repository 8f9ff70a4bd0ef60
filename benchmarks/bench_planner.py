"""Planning a million moves: path with blends, and both profiles' passes, apart and together; and the anchors' times.

The chains are held in memory as moves, so that neither reading nor a disk is timed.  The first round of every case is
not measured: it also pays for memory that the system hands out for the first time.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import Case, report
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.program import MOVE, MoveKind, Program
from trochia.toolpath import build

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine

MOVES = 1_000_000
FAST = 3_000_000  #: segments a second a planner must do
SMOOTH = 400_000  #: segments a second with limited jerk
ANCHORS = Path(__file__).parents[1] / "tests" / "golden" / "anchors"


def chain(points: NDArray[np.float64], feed: float = 100.0) -> Program:
    """Return a program of straight feeds through points (k, 3)."""
    moves = np.zeros(len(points), dtype=MOVE)
    moves["target"][:, :3], moves["kind"], moves["rate"] = points, MoveKind.FEED, feed
    moves["line"] = np.arange(1, len(points) + 1)
    return Program(name="chain", lines=len(points), start=np.zeros(9), moves=moves, actions=())


def quarters(count: int) -> Program:
    """Return a program of quarter circles joined at right tangents, radius 1 to 4 mm."""
    moves = np.zeros(count, dtype=MOVE)
    radius = 1.0 + np.arange(count) % 4
    sign = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
    ends = np.zeros((count + 1, 2))
    # right then up, up then right: a staircase of quarters, each tangent to the next
    ends[1:] = np.cumsum(np.stack([radius, radius], axis=1), axis=0)
    moves["target"][:, :2], moves["kind"], moves["rate"] = ends[1:], MoveKind.ARC, 100.0
    right = sign > 0
    moves["centre"][:, 0] = np.where(right, ends[:-1, 0], ends[1:, 0])
    moves["centre"][:, 1] = np.where(right, ends[1:, 1], ends[:-1, 1])
    moves["turns"], moves["line"] = np.where(right, 1, -1), np.arange(1, count + 1)
    return Program(name="quarters", lines=count, start=np.zeros(9), moves=moves, actions=())


def programs() -> dict[str, Program]:
    u = np.arange(1, MOVES + 1) * 0.2
    walk = np.cumsum(np.random.default_rng(1).normal(size=(MOVES, 3)) * 0.2, axis=0) % 300
    return {
        "curve, chords 0.4 to 0.6 mm": chain(
            np.stack([100 * np.sin(u / 50), 80 * np.sin(u / 37), 10 * np.sin(u / 91)], 1)
        ),
        "random walk": chain(walk),
        "zig-zag 0.2 mm": chain(np.stack([u % 200, 0.1 * (np.arange(MOVES) % 2), 0 * u], axis=1)),
        "quarter circles (100,000)": quarters(MOVES // 10),
    }


def cases(name: str, program: Program, machine: Machine) -> list[Case]:
    path = build(program, machine)
    count = len(program.moves)
    target = FAST if count == MOVES else None  # an arc is eighteen pieces, not a short segment
    smooth = build(program, machine, continuity=2)
    size = (program.moves.nbytes + path.segments.nbytes + path.pool.nbytes) / count
    return [
        Case(name=f"{name}: path, {size:.0f} bytes a move", call=lambda: build(program, machine), count=count),
        Case(name=f"{name}: plan", call=lambda: plan(path, machine, program=program), count=count, target=target),
        Case(
            name=f"{name}: both",
            call=lambda: plan(build(program, machine), machine, program=program),
            count=count,
            target=target,
        ),
        Case(
            name=f"{name}: plan with limited jerk, segments",
            call=lambda: plan(smooth, machine, program=program, profile="s-curve"),
            count=len(smooth),
            target=SMOOTH if target else None,
        ),
    ]


def anchors(machine: Machine) -> None:
    """Print the motion times of the anchor programs beside the reference's."""
    smooth = {row["program"]: row for row in csv.DictReader((ANCHORS / "s-curve.csv").read_text().splitlines())}
    print("\nMotion times [s] on reference-mill\n")
    print("| program | trapezoid | reference, better trapezoid | its bound | limited jerk | its bound |")
    print("|---|---|---|---|---|---|")
    for row in csv.DictReader((ANCHORS / "anchors.csv").read_text().splitlines()):
        program = gcode.read((ANCHORS / f"{row['program']}.ngc").read_text(), name=row["program"])
        time = plan(build(program, machine), machine, program=program).duration
        path = build(program, machine, continuity=2)
        jerk = plan(path, machine, program=program, profile="s-curve").duration
        bounds = (row["bound_s"] or "none given", smooth[row["program"]]["bound_s"] or "none given")
        print(f"| {row['program']} | {time:.4f} | {row['reference_s']} | {bounds[0]} | {jerk:.4f} | {bounds[1]} |")


def main() -> None:
    machine = load("reference-mill")
    for name, program in programs().items():
        report(f"Planning: {name}", "moves", cases(name, program, machine), runs=3)
    anchors(machine)


if __name__ == "__main__":
    main()
