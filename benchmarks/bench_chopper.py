"""A stepper behind a chopper: every switching at 1 us, as a ratio to a plain C loop of the same equations.

The plain loop is what one writes down first: the currents step exactly, the mechanics semi-implicitly, wanted levels
are looked up at every step, nothing is recorded.  Ours takes pulses from a queue and goes through the Python face,
samples and lost steps included.  The averaged model at 20 us does the same seconds of motion; it is no ratio of equals.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import Case, report
from trochia.backends.stepper_twin import MEAN, SWITCHED, Levels, StepperTwin
from trochia.machine.drivers import Chopper, Fed, fed
from trochia.machine.motors import ShaftLoad, motor

if TYPE_CHECKING:
    from collections.abc import Callable

PLAIN = """
#include <math.h>
#include <stdint.h>
typedef struct { double r, l, k, p, j, f, b, supply, amps, off, blank, fast; } motor;
typedef struct { double off, blank; } phase;
static double drive(const motor *m, phase *w, double level, double i, double dt) {
    if (level == 0) { w->off = w->blank = 0; return i > 0 ? -m->supply : i < 0 ? m->supply : NAN; }
    double sign = level < 0 ? -1 : 1, x = i * sign;
    if (w->off > 0) { w->off -= dt; if (w->off <= dt / 2) { w->off = 0; w->blank = m->blank; } }
    else if (w->blank > 0) w->blank -= dt;
    if (w->off == 0 && w->blank <= dt / 2 && x >= fabs(level) * m->amps) { w->off = m->off; w->blank = 0; }
    if (w->off == 0) return sign * m->supply;
    return w->off > (1 - m->fast) * m->off + dt / 2 && x > 0 ? -sign * m->supply : 0;
}
static double current(const motor *m, double i, double v, double e, double dt) {
    if (isnan(v)) return 0;
    double left = exp(-dt * m->r / m->l), next = i * left + (v - e) * (1 - left) / m->r;
    return v * i < 0 && next * i < 0 ? 0 : next;
}
double plain(const double *c, const double *table, int64_t rows, double rate, double dt, int64_t steps) {
    motor m = {c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9], c[10], c[11]};
    phase a = {0, 0}, b = {0, 0};
    double ia = 0, ib = 0, x = 0, w = 0;
    for (int64_t n = 0; n < steps; n++) {
        int64_t row = (int64_t)((double)n * dt * rate) % rows;
        double s = sin(m.p * x), o = cos(m.p * x);
        double va = drive(&m, &a, table[2 * row], ia, dt), vb = drive(&m, &b, table[2 * row + 1], ib, dt);
        ia = current(&m, ia, va, -m.k * w * s, dt);
        ib = current(&m, ib, vb, m.k * w * o, dt);
        double t = m.k * (ib * o - ia * s) - m.b * w - m.f * w / sqrt(w * w + 0.01);
        w += dt / m.j * t;
        x += dt * w;
    }
    return x;
}
"""
SECONDS, RATE, DT = 0.5, 400.0, 1e-6
STEPS = round(SECONDS / DT)
LOAD = ShaftLoad(inertia=2e-5, friction=0.02, viscous=1e-3)


def plain_loop(folder: Path, made: Fed, chopper: Chopper) -> Callable[[], object]:
    """Return the plain loop, compiled with the core's own flags."""
    source, library = folder / "plain.c", folder / "plain.so"
    source.write_text(PLAIN)
    flags = ["-std=c11", "-O3", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    call = ctypes.CDLL(str(library)).plain
    call.restype = ctypes.c_double
    stepper, levels = made.motor, made.excitation.levels
    constants = (ctypes.c_double * 12)(
        stepper.resistance, stepper.inductance, stepper.torque_constant, stepper.teeth, stepper.inertia + LOAD.inertia,
        stepper.friction + LOAD.friction, stepper.viscous + LOAD.viscous, chopper.supply, chopper.current,
        chopper.off_time, chopper.blanking, chopper.fast_part,
    )  # fmt: skip
    table = (ctypes.c_double * levels.size)(*levels.ravel())
    rows, rate = ctypes.c_int64(len(levels)), ctypes.c_double(RATE * made.excitation.steps_per_full_step)
    return lambda: call(constants, table, rows, rate, ctypes.c_double(DT), ctypes.c_int64(STEPS))


def ours(made: Fed, levels: Levels) -> Callable[[], object]:
    """Return the twin's run of the same motion, in one of its levels."""
    rate = RATE * made.excitation.steps_per_full_step
    pulses = np.arange(1, int(SECONDS * rate)) / rate

    def run() -> int:
        twin = StepperTwin(made, LOAD, levels=levels)
        twin.queue(pulses)
        return int(twin.run(SECONDS, every=50).lost_steps[-1])

    return run


def main() -> None:
    chopper = Chopper(supply=24.0, current=2.0)
    made = fed(motor("QSH5718-55").parameters(), chopper, 16)
    with tempfile.TemporaryDirectory() as folder:
        plain = plain_loop(Path(folder), made, chopper)
        report(
            "A stepper behind a chopper, 1 us",
            "us of motion",
            [
                Case(name="plain C loop", call=plain, count=STEPS, reference=True),
                Case(name="every switching, every 1 ms a sample", call=ours(made, SWITCHED), count=STEPS),
                Case(name="on average, at 20 us (other equations)", call=ours(made, MEAN), count=STEPS),
            ],
        )


if __name__ == "__main__":
    main()
