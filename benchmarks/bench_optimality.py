"""Motion times of programs of every kind against the least times along the very same path.

Trapezoids against TOPP-RA, which knows no feeds: it is shown where these do not bind.  Limited jerk against the least
time that `third_order.py` finds: one that can be reached along that path, so at or above the least there is.  The rule:
where that is up to 1.05 times the trapezoid's, limited jerk takes up to 1.15 times the trapezoid's; elsewhere up to 1.4
times that least time.
"""

from __future__ import annotations

import dataclasses
import math
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import toppra
from toppra.interpolator import AbstractGeometricPath

import shapes
from bench_curvature import machine_of
from third_order import third_order
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.planner.limits import Limits
from trochia.toolpath import build

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.program import Program
    from trochia.toolpath import Toolpath


ANCHORS = Path(__file__).parents[1] / "tests" / "golden" / "anchors"


def finishing() -> str:
    """Return passes over a wavy surface in chords of 0.3 mm, as CAM writes them."""
    lines = ["G64 P0.01", "F60000"]
    for row in range(3):
        xs = np.arange(0.0, 30.0, 0.3)
        lines += [
            f"G1 X{x:.4f} Y{0.4 * row:.4f} Z{2.0 * math.sin(x / 4.0) + 0.5 * math.cos(x / 1.7):.4f}"
            for x in (xs if row % 2 == 0 else xs[::-1])
        ]
    return "\n".join(lines)


PROGRAMS = {
    "3D finishing": ("reference-mill", finishing()),
    "tangent lines and arcs": (
        "reference-mill",
        "G64 P0.01\nF60000\nG1 X20\nG3 X30 Y10 J10\nG1 Y25\nG2 X45 Y40 I15\nG1 X60\nG3 X64 Y44 J4\nG1 Y60",
    ),
    "slots": ("reference-mill", "G64 P0.01\nF60000\nG1 X30\nG3 X30 Y8 J4\nG1 X0\nG2 X0 Y16 J4\nG1 X30"),
    "short corners": (
        "reference-mill",
        "G64 P0.01\nF60000\n" + "\n".join(f"G1 X{(k + 1) // 2 * 2} Y{k // 2 * 2}" for k in range(1, 21)),
    ),
    "helices": ("reference-mill", "G64 P0.01\nF60000\nG3 X0 Y0 I8 Z-3 P3\nG1 X5 Y-5 Z0\nG2 X25 Y-5 I10 Z4"),
    "circle, radius 1 mm": ("reference-mill", "F60000\nG3 X0 Y0 I1"),
    "circle, radius 10 mm": ("reference-mill", "F60000\nG3 X0 Y0 I10"),
    "rotary": ("rotary-mill", "G64 P0.02\nF60000\nG1 X10 A20\nX20 A60\nY10 A60\nX0 Y20 A0"),
    "feed changes": ("reference-mill", "G64 P0.05\nG1 X10 F60000\nX20 F1200\nY10\nX30 F60000\nY20 F600\nX40 F60000"),
    "locked to the spindle": ("reference-mill", "G64 P0.01\nS600 M3\nG95 F1\nG1 X10\nX20 Y10\nX30\nY0"),
}


def optimum(path: Toolpath, machine: Machine) -> float:
    """Return the least time [s] of a path without stops, by TOPP-RA with limits kept between its points too."""
    starts = np.concatenate([[0.0], np.cumsum(path.segments["length"])])

    class Path(AbstractGeometricPath):
        dof = len(path.axes)
        path_interval = starts[[0, -1]]
        waypoints = None

        def __call__(self, at, order=0):  # noqa: ANN001, ANN204 - the library's signature
            at = np.atleast_1d(at)
            rows = np.clip(np.searchsorted(starts, at, "right") - 1, 0, len(path) - 1)
            return path.points(rows, at - starts[rows], order)

    kinds = ("velocity", "acceleration")
    boxes = [np.array([[-getattr(a, kind), getattr(a, kind)] for a in machine.axes]) for kind in kinds]
    grid = np.unique(
        np.concatenate([np.linspace(a, b, 13) for a, b in pairwise(starts)] + [np.linspace(0, starts[-1], 1500)])
    )
    grid = grid[np.concatenate([[True], np.diff(grid) > 1e-9])]
    middle = np.searchsorted(starts, grid, "right") - 1
    feed = np.append(path.segments["speed_limit"], np.inf)[np.clip(middle, 0, len(path) - 1)]
    rules = [
        toppra.constraint.JointVelocityConstraint(boxes[0]),
        toppra.constraint.JointAccelerationConstraint(
            boxes[1], discretization_scheme=toppra.constraint.DiscretizationType.Interpolation
        ),
    ]
    solver = toppra.algorithm.TOPPRA(rules, Path(), gridpoints=grid, solver_wrapper="seidel")
    speed = solver.compute_parameterization(0, 0)[1]
    if (speed[:-1] > feed[:-1] * 1.01).any():
        return math.nan  # the feed binds, of which this optimum knows nothing
    return float((2.0 * np.diff(grid) / (speed[1:] + speed[:-1])).sum())


class Times(NamedTuple):
    """Motion times of one program [s]: planned, the second-order optimum (nan: none), and the third-order one found."""

    trapezoid: float
    second: float
    third: float
    jerk: float

    @property
    def row(self) -> str:
        """Return the table's columns, the last of them whether the rule is kept."""
        near = self.third <= 1.05 * self.trapezoid
        most = 1.15 * self.trapezoid if near else 1.4 * self.third
        shown = f"{self.second:.4f} | {self.trapezoid / self.second:.4f}" if math.isfinite(self.second) else " | "
        return (
            f"{self.trapezoid:.4f} | {shown} | {self.third:.4f} | {self.third / self.trapezoid:.3f} | {self.jerk:.4f}"
            f" | {self.jerk / self.trapezoid:.3f} | {self.jerk / self.third:.3f}"
            f" | {'1.15 trapezoid' if near else '1.4 bound'} {'kept' if self.jerk <= most else 'BROKEN'} |"
        )


def times_of(program: Program, machine: Machine, *, second: bool, step: float = 0.1) -> Times:
    path = build(program, machine)
    alone = second and path.segments["stop"].sum() == 1
    smooth = plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve")
    jerk = smooth.times["motion"]
    return Times(
        trapezoid=plan(path, machine, program=program, profile="trapezoid").times["motion"],
        second=optimum(path, machine) if alone else math.nan,
        third=min(third_order(smooth.path, Limits.of(machine), smooth, step), jerk),  # a plan can be followed as well
        jerk=jerk,
    )


def smooth_machine(model: str) -> Machine:
    """Return a machine with a jerk limit on every axis: 25 times its acceleration a second where none is given."""
    machine = load(model)
    return dataclasses.replace(
        machine,
        axes=tuple(dataclasses.replace(axis, jerk=axis.jerk or 25.0 * axis.acceleration) for axis in machine.axes),
    )


def anchors() -> dict[str, Program]:
    return {path.stem: gcode.read(path.read_text(), name=path.stem) for path in sorted(ANCHORS.glob("*.ngc"))}


#: The corner model's files, of which the second-order optimum is in closed form (`bench_curvature.py`), in short.
CORNERS = {
    "curve, 300 x 0.2 mm": shapes.curve(300),
    "… chords 0.14 to 0.26 mm": shapes.curve(300, spread=0.3),
    "mixed, 100": shapes.mixed(100),
    "zig-zag, 33 x 1 mm": shapes.zigzag(33),
    "hatch, 33": shapes.hatch(33),
}


def main() -> None:
    toppra.setup_logging("ERROR")
    print("\n## Programs of every kind\n")
    print(
        "| program | trapezoid [s] | TOPP-RA, same path [s] | ratio | third-order bound, same path [s]"
        " | to the trapezoid | limited jerk [s] | to the trapezoid | to the bound | rule |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, (model, text) in PROGRAMS.items():
        times = times_of(gcode.read(text + "\nM2\n"), smooth_machine(model), second=True)
        print(f"| {name} | {times.row}", flush=True)
    for name, program in anchors().items():
        print(f"| {name} | {times_of(program, load('reference-mill'), second=False).row}", flush=True)
    for speed, acceleration, faster in ((100.0, 1000.0, ""), (300.0, 2000.0, ", faster")):
        for name, points in CORNERS.items():
            times = times_of(shapes.chain(points, speed), machine_of(acceleration), second=False, step=0.3)
            print(f"| {name}{faster} | {times.row}", flush=True)


if __name__ == "__main__":
    main()
