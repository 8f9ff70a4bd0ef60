"""One voltage-driven stepper at 20 us: time steps a second, as a ratio to a plain C loop of the same equations.

The plain loop is what one writes down first: Runge-Kutta over an array of four, the voltage chosen anew at each time
step, nothing recorded.  Ours takes each pulse at its own instant and goes through the Python face, pulses, samples and
lost steps included.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import Case, report
from trochia.backends.stepper_twin import STEP, StepperTwin
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import HybridStepper, motor
from trochia.pulses.excitation import Excitation, excitation

if TYPE_CHECKING:
    from collections.abc import Callable

PLAIN = """
#include <math.h>
#include <stdint.h>
typedef struct { double r, l, k, p, d, j, b, va, vb; } motor;
static void rate(const motor *m, const double *y, double *out) {
    double s = sin(m->p * y[2]), c = cos(m->p * y[2]);
    double torque = m->k * (y[1] * c - y[0] * s) - 4 * m->d * s * c * (1 - 2 * s * s) - m->b * y[3];
    out[0] = (m->va - m->r * y[0] + m->k * y[3] * s) / m->l;
    out[1] = (m->vb - m->r * y[1] - m->k * y[3] * c) / m->l;
    out[2] = y[3];
    out[3] = torque / m->j;
}
static void step(const motor *m, double *y, double h) {
    double k1[4], k2[4], k3[4], k4[4], z[4];
    rate(m, y, k1);
    for (int i = 0; i < 4; i++) z[i] = y[i] + h / 2 * k1[i];
    rate(m, z, k2);
    for (int i = 0; i < 4; i++) z[i] = y[i] + h / 2 * k2[i];
    rate(m, z, k3);
    for (int i = 0; i < 4; i++) z[i] = y[i] + h * k3[i];
    rate(m, z, k4);
    for (int i = 0; i < 4; i++) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
}
double plain(const double *constants, const double *table, int64_t rows, double speed, double h, int64_t ticks) {
    motor m = {constants[0], constants[1], constants[2], constants[3], constants[4], constants[5], constants[6], 0, 0};
    double y[4] = {0, 0, 0, 0};
    for (int64_t i = 0; i < ticks; i++) {
        int64_t row = (int64_t)((double)i * h * speed) % rows;
        m.va = table[2 * row];
        m.vb = table[2 * row + 1];
        step(&m, y, h);
    }
    return y[2];
}
"""
SECONDS, RATE, VOLTS = 5.0, 200.0, 9.4
TICKS = round(SECONDS / STEP)


def plain_loop(folder: Path, stepper: HybridStepper, mode: Excitation) -> Callable[[], object]:
    """Return the plain loop, compiled with the core's own flags."""
    source, library = folder / "plain.c", folder / "plain.so"
    source.write_text(PLAIN)
    flags = ["-std=c11", "-O3", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    call = ctypes.CDLL(str(library)).plain
    call.restype = ctypes.c_double
    constants = (ctypes.c_double * 7)(
        stepper.resistance, stepper.inductance, stepper.torque_constant, stepper.teeth, stepper.detent,
        stepper.inertia, stepper.viscous,
    )  # fmt: skip
    table = (ctypes.c_double * mode.levels.size)(*(VOLTS * mode.levels).ravel())
    rows, rate = ctypes.c_int64(len(mode.levels)), ctypes.c_double(RATE * mode.steps_per_full_step)
    return lambda: call(constants, table, rows, rate, ctypes.c_double(STEP), ctypes.c_int64(TICKS))


def ours(stepper: HybridStepper, mode: Excitation, every: int) -> Callable[[], object]:
    """Return the twin's run of the same motion."""
    pulses = np.arange(1, int(SECONDS * RATE * mode.steps_per_full_step)) / (RATE * mode.steps_per_full_step)

    made = fed(stepper, HBridge(supply=VOLTS, drop=0.0, excitation=mode.name))

    def run() -> int:
        twin = StepperTwin(made)
        twin.queue(pulses)
        return int(twin.run(SECONDS, every=every).lost_steps[-1])

    return run


def main() -> None:
    stepper = motor("SM-42BYG011-25").parameters()
    full = excitation("two-phase")
    with tempfile.TemporaryDirectory() as folder:
        plain = plain_loop(Path(folder), stepper, full)
        report(
            f"One stepper, voltage drive, {STEP * 1e6:g} us",
            "time steps",
            [
                Case(name="plain C loop", call=plain, count=TICKS, reference=True),
                Case(name="full steps, every 50th sample", call=ours(stepper, full, 50), count=TICKS),
                Case(name="full steps, every sample", call=ours(stepper, full, 1), count=TICKS),
                Case(name="16 microsteps, every 50th sample", call=ours(stepper, excitation("microstep-16"), 50),
                     count=TICKS),
            ],
        )  # fmt: skip


if __name__ == "__main__":
    main()
