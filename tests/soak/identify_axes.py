"""Two-mass axes that nobody knows, found and tuned on what was found; all judged on the true ones.

    python tests/soak/identify_axes.py --count 10 --seed 2026

Axis N of a seed is the N-th drawn: peak at 25 to 120 Hz, damping 1 to 6 %, load 0.5 to 4 times the motor, encoders of
10,000 to 65,536 counts a turn on the motor, a gap of 3 to 30 counts, Coulomb friction on both sides.  Exit code 1: an
axis missed its goal (inertias, stiffness, viscous friction 5 %, damping 20 %, gap one count; stable with Ms <= 1.7, and
settled before Ziegler and Nichols' PID).
"""

from __future__ import annotations

import argparse
import importlib.util
from pathlib import Path
from typing import Any

import numpy as np

from trochia.analysis.tuning import loop_margins, shape
from trochia.analysis.tuning.classic import single_loop, ultimate
from trochia.analysis.tuning.rules import ziegler_nichols_closed
from trochia.analysis.tuning.shaping import step_on_twin
from trochia.experiments import Bounds, TwinAxis, identify

PERIOD, LIMIT = 5e-4, 20.0
BOUNDS = Bounds(low=-250.0, high=250.0, command=LIMIT)
GOALS = {"motor_inertia": 0.05, "load_inertia": 0.05, "stiffness": 0.05, "damping": 0.2, "viscous": 0.05}


def judged(truth: Any) -> tuple[bool, str]:
    """Return whether an axis met its goals, and a line that says how."""
    found = identify(TwinAxis(truth, PERIOD), BOUNDS, speed=30.0, reach=2.0)
    assert found.train is not None, "two masses"
    assert found.gap is not None, "two masses"
    true = {name: getattr(truth, name) for name in GOALS if name != "viscous"}
    true["viscous"] = truth.motor_friction.viscous + truth.load_friction.viscous
    off = {name: found.train[name] / true[name] - 1.0 for name in GOALS}
    counts = (found.gap["gap"] - truth.gap) * truth.counts
    shaped = shape(found.plant, PERIOD, limit=LIMIT)
    margins, step = loop_margins(truth, shaped.loop), step_on_twin(truth, shaped.loop, 0.1)
    classic = single_loop(ziegler_nichols_closed(ultimate(truth, PERIOD)), PERIOD, limit=LIMIT)
    zn = step_on_twin(truth, classic, 0.1)
    good = (all(abs(off[name]) <= goal for name, goal in GOALS.items()) and abs(counts) <= 1.0
            and margins.stable and margins.ms <= 1.7 and step.settling < zn.settling)  # fmt: skip
    errors = " ".join(f"{name} {value:+.1%}" for name, value in off.items())
    return good, (f"{errors} gap {counts:+.2f} counts | Ms {margins.ms:.3f} settles {step.settling * 1e3:.0f} ms, "
                  f"Ziegler-Nichols {zn.settling * 1e3:.0f} ms")  # fmt: skip


def drawn(count: int, seed: int) -> list[Any]:
    """Return axes as the tests draw them."""
    place = Path(__file__).parents[1] / "unit" / "experiments" / "conftest.py"
    spec = importlib.util.spec_from_file_location("axes_drawn", place)
    assert spec is not None, "the file is there"
    assert spec.loader is not None, "the file is there"
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    rng = np.random.default_rng(seed)
    return [module.drawn(rng) for _ in range(count)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=2026)
    given = parser.parse_args()
    bad = 0
    for number, truth in enumerate(drawn(given.count, given.seed)):
        good, said = judged(truth)
        bad += not good
        print(f"axis {number}: {'met   ' if good else 'MISSED'} {said}", flush=True)
    print(f"{given.count - bad} of {given.count} axes of seed {given.seed} met their goals")
    raise SystemExit(int(bad > 0))


if __name__ == "__main__":
    main()
