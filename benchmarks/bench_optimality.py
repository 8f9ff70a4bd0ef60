"""Motion times of programs of every kind against the second-order optimum (TOPP-RA) of the very same path.

TOPP-RA knows no feeds: it is shown where these do not bind.  The last column compares limited jerk with the trapezoid.
"""

from __future__ import annotations

import dataclasses
import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import toppra
from toppra.interpolator import AbstractGeometricPath

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.toolpath import build

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.toolpath import Toolpath


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


def main() -> None:
    toppra.setup_logging("ERROR")
    print("\n## Programs of every kind\n")
    print("| program | trapezoid [s] | TOPP-RA, same path [s] | ratio | limited jerk [s] | to the trapezoid |")
    print("|---|---|---|---|---|---|")
    for name, (model, text) in PROGRAMS.items():
        machine = load(model)
        axes = tuple(
            axis if axis.jerk else dataclasses.replace(axis, jerk=25.0 * axis.acceleration) for axis in machine.axes
        )
        machine = dataclasses.replace(machine, axes=axes)
        program = gcode.read(text + "\nM2\n")
        path = build(program, machine)
        time = plan(path, machine, program=program, profile="trapezoid").times["motion"]
        jerk = plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve").times["motion"]
        best = optimum(path, machine) if path.segments["stop"].sum() == 1 else math.nan
        shown = f"{best:.4f} | {time / best:.4f}" if math.isfinite(best) else "feed or stops bind | "
        print(f"| {name} | {time:.4f} | {shown} | {jerk:.4f} | {jerk / time:.3f} |")


if __name__ == "__main__":
    main()
