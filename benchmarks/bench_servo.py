"""A DC cascade on two masses with a gap and Stribeck friction at 10 us, as a ratio to a plain C loop of its equations.

The plain loop is what one writes down first: the same midpoint steps in one function over local doubles, the cascade at
every hundredth step, nothing recorded.  Ours records seven values a tick and goes through the Python face.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness import Case, report
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, ServoPlant
from trochia.servo import Loop, Pid, ServoAxis

if TYPE_CHECKING:
    from collections.abc import Callable

PLAIN = """
#include <math.h>
#include <stdint.h>
static double clip(double x, double m) { return x > m ? m : x < -m ? -m : x; }
static double rub(double fc, double fs, double ws, double b, double eps, double w) {
    double x = w / ws;
    return (fc + (fs - fc) * exp(-x * x)) * tanh(w / eps) + b * w;
}
double plain(const double *p, int64_t ticks, int64_t steps, double period, double h) {
    double r = p[0], l = p[1], kt = p[2], jm = p[3], jl = p[4], k = p[5], d = p[6], half = p[7] / 2, vmax = p[8];
    double kp = p[9], kv = p[10], ki = p[11], kc = p[12], kci = p[13], imax = p[14];
    double keep = exp(-h * r / l);
    double x = 0, y = 0, w = 0, z = 0, i = 0, a = 0, b = 0, sum = 0, csum = 0, last = 0;
    for (int64_t n = 0; n < ticks; n++) {
        double want = sin((double)n * period * 6.0), speed = (x - last) / period;
        last = x;
        double e = kp * (want - x) - speed;
        sum += ki * period * e;
        double icmd = clip(kv * e + sum, imax);
        for (int64_t s = 0; s < steps; s++) {
            double ec = icmd - i;
            csum += kci * h * ec;
            double v = clip(kc * ec + csum, vmax);
            double wm = w + 0.5 * h * a, zm = z + 0.5 * h * b;
            double xm = x + 0.5 * h * w, ym = y + 0.5 * h * z;
            double before = i;
            i = keep * i + (1 - keep) * (v - kt * wm) / r;
            double twist = xm - ym, c = 0;
            if (twist > half) c = k * (twist - half) + d * (wm - zm);
            else if (twist < -half) c = k * (twist + half) + d * (wm - zm);
            a = (kt * 0.5 * (before + i) - rub(p[15], p[16], p[17], p[18], p[19], wm) - c) / jm;
            b = (c - rub(p[20], p[21], p[17], p[22], p[19], zm)) / jl;
            w += h * a; z += h * b;
            x = xm + 0.5 * h * w; y = ym + 0.5 * h * z;
        }
    }
    return x;
}
"""
SECONDS, PERIOD, STEP = 20.0, 1e-3, 1e-5
TICKS = round(SECONDS / PERIOD)
DRY = Friction(coulomb=0.01, stick=0.015, stribeck=2.0, viscous=1e-4, smooth=0.05)
FAR = Friction(coulomb=0.004, stick=0.006, stribeck=2.0, viscous=2e-4, smooth=0.05)
PLANT = ServoPlant(
    amplifier=Amplifier(mode=Mode.VOLTAGE, voltage=24.0), resistance=1.5, inductance=2e-3, torque_constant=0.1,
    emf_constant=0.1, motor_inertia=1e-4, load_inertia=3e-4, stiffness=20.0, damping=2e-3, gap=0.02,
    motor_friction=DRY, load_friction=FAR,
)  # fmt: skip
LOOP = Loop(period=PERIOD, position=Pid(kp=20.0), speed=Pid(kp=0.4, ki=4.0, limit=8.0),
            current=Pid(kp=2.0, ki=1500.0, limit=24.0))  # fmt: skip


def plain_loop(folder: Path) -> Callable[[], object]:
    """Return the plain loop, compiled with the core's own flags."""
    source, library = folder / "plain.c", folder / "plain.so"
    source.write_text(PLAIN)
    flags = ["-std=c11", "-O3", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    call = ctypes.CDLL(str(library)).plain
    call.restype = ctypes.c_double
    numbers = [1.5, 2e-3, 0.1, 1e-4, 3e-4, 20.0, 2e-3, 0.02, 24.0, 20.0, 0.4, 4.0, 2.0, 1500.0, 8.0,
               0.01, 0.015, 2.0, 1e-4, 0.05, 0.004, 0.006, 2e-4]  # fmt: skip
    constants = (ctypes.c_double * len(numbers))(*numbers)
    steps = ctypes.c_int64(round(PERIOD / STEP))
    return lambda: call(constants, ctypes.c_int64(TICKS), steps, ctypes.c_double(PERIOD), ctypes.c_double(STEP))


def ours() -> float:
    """Run the same cascade; return where the motor is at the end."""
    t = PERIOD * np.arange(TICKS)
    wanted = np.stack([np.sin(6.0 * t), np.zeros(TICKS), np.zeros(TICKS)], axis=1)
    return float(ServoAxis(PLANT, LOOP, step=STEP).run(wanted).motor[-1])


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        plain = plain_loop(Path(folder))
        print(f"where the motor is at the end: plain {plain():.6f}, ours (a tick earlier) {ours():.6f}")
        report(
            f"DC cascade, two masses, gap, Stribeck, {STEP * 1e6:g} us: {SECONDS:g} s simulated",
            "simulated seconds",
            [
                Case(name="plain C loop", call=plain, count=round(SECONDS), reference=True),
                Case(name="servo axis", call=ours, count=round(SECONDS)),
            ],
        )


if __name__ == "__main__":
    main()
