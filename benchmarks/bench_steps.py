"""Step timing: steps a second of both kernels, as a ratio to a plain C loop, one root a step, run in the same call.

The plain loop is what one writes down first: each step's quadratic solved with ``sqrt``, rounded with ``llround``.
Ours go through the Python face, buffers and copies included; the last row goes from a trajectory to step blocks.
"""

from __future__ import annotations

import ctypes
import math
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import Case, report
from trochia.kernels.layout import PHASE, SEGMENT
from trochia.kernels.steps import JointSteps
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.pulses import CLOCK, step_blocks
from trochia.toolpath import build

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

PLAIN = """
#include <math.h>
#include <stdint.h>
void plain(int64_t n, double v, double a, double clock, int64_t *ticks) {
    for (int64_t k = 1; k <= n; k++)
        ticks[k - 1] = llround(clock * (sqrt(v * v + 2.0 * a * (double)k) - v) / a);
}
"""
STEPS = 2_000_000
CONSTANT, GENERAL = 150_000_000, 40_000_000  #: steps a second the two kernels must do
LINE, ARC, CUBIC = range(3)


def plain_loop(folder: Path) -> Callable[[], object]:
    """Return a call of the plain loop over STEPS steps from 1000 steps/s at 4000 steps/s²."""
    (folder / "plain.c").write_text(PLAIN)
    flags = ["-std=c11", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared"]
    subprocess.run(["gcc", *flags, "-o", folder / "plain.so", folder / "plain.c", "-lm"], check=True)
    plain = ctypes.CDLL(str(folder / "plain.so")).plain
    plain.argtypes = [ctypes.c_int64, *(ctypes.c_double,) * 3, ctypes.c_void_p]
    ticks = np.empty(STEPS, dtype=np.int64)
    return lambda: plain(STEPS, 1000.0, 4000.0, float(CLOCK), ticks.ctypes.data)


def phase(duration: float, v: float, a: float = 0.0, j: float = 0.0) -> NDArray[np.void]:
    rows = np.zeros(1, dtype=PHASE)
    rows["duration"], rows["v"], rows["a"], rows["j"] = duration, v, a, j
    return rows


def kernel(
    name: str, kind: int, pool: list[float], row: float, phases: NDArray[np.void], *, target: float = GENERAL
) -> Case:
    """Return a case of one joint over one phase, in windows of a hundredth of it."""
    segments = np.zeros(1, dtype=SEGMENT)
    segments["kind"], segments["length"], segments["second"] = kind, 1e4, 1
    given = segments, np.array(pool), np.array([row, 0.0]), float(CLOCK)
    windows = np.linspace(0, float(phases["duration"][0]) * CLOCK, 101)[1:]
    windows[-1] = np.inf

    def run() -> int:
        joint = JointSteps(*given, 0 if kind != ARC else round(pool[2] * row))
        joint.load(phases)
        return sum(joint.until(window)[0].size for window in windows)

    return Case(name=name, call=run, count=run(), target=target)


def kernels(folder: Path) -> list[Case]:
    """Return the plain loop and both kernels on the motions they are for."""
    line, radius = [0.0, 0.0, 1.0, 0.0], 100.0
    circle = [0.0, 0.0, radius, 0.0, 1 / radius, *(0.0,) * 6]
    speeding = (math.sqrt(1000**2 + 2 * 4000 * STEPS) - 1000) / 4000
    return [
        Case(name="plain C loop", call=plain_loop(folder), count=STEPS, reference=True),
        kernel("line, constant acceleration", LINE, line, 1.0, phase(speeding, 1000.0, 4000.0), target=CONSTANT),
        kernel("line, constant speed", LINE, line, 1.0, phase(STEPS / 1e5, 1e5), target=CONSTANT),
        kernel("line, jerk", LINE, line, 1.0, phase(20.0, 0.0, 0.0, 6.0 * STEPS / 20.0**3)),
        kernel("circle, steady, 2000 steps a radius", ARC, circle, 20.0, phase(50 * math.tau, 2 * radius)),
        kernel("circle, steady, 200 steps a radius", ARC, circle, 2.0, phase(500 * math.tau, 2 * radius)),
        kernel("circle, speeding up", ARC, circle, 20.0, phase(100.0, 0.0, 12.0)),
        kernel("cubic", CUBIC, [0, 0, 1, 0, 1e-3, 0, 1e-6, 0], 400.0, phase(10.0, 100.0)),
    ]


def whole() -> Case:
    """Return a job of arcs and blended lines from its trajectory to all joints' step blocks."""
    machine = load("reference-mill")
    points = [f"G1 X{40 * math.cos(k):.3f} Y{40 * math.sin(k):.3f}\nG2 X0 Y0 R50" for k in range(500)]
    program = gcode.read("G21 G64 P0.05 F9000\n" + "\n".join(points) + "\nM2\n", axes="XYZ")
    motion = plan(build(program, machine), machine, program=program)

    def run() -> int:
        return sum(ticks.size for block in step_blocks(motion, machine) for ticks in block.ticks)

    return Case(name=f"lines and arcs, {motion.duration:.0f} s of three joints", call=run, count=run(), target=GENERAL)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        report("Step timing", "steps", [*kernels(Path(folder)), whole()])


if __name__ == "__main__":
    main()
