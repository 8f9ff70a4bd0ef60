"""A published measurement of the shield's motor, no load: four limits, found with a library that waits milliseconds.

Pull-out at 200 and 150 rpm with both phases on and with one, start/stop at 170 and 100.  The machine ``shield-bench``
stands for the bench; ``docs/explanation/steppers.md`` gives the reason for each of its values.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import trochia
from trochia.analysis.sweep import TIMINGS, compare, pull_out_speed, start_stop_speeds
from trochia.machine.motors import motor
from trochia.machine.motors.excitation import excitation
from trochia.machine.torque import Drive, drive

RPM = math.pi / 30
MEASURED = {
    "pull-out": {"two-phase": 200.0, "one-phase": 150.0},
    "start/stop": {"two-phase": 170.0, "one-phase": 100.0},
}
CASES = [(limit, mode) for limit, of in MEASURED.items() for mode in of]
#: where a search begins here [rpm]: lower than the sketches' 50 takes time and, but for start/stop, changes nothing
FROM = {("pull-out", "two-phase"): 120, ("pull-out", "one-phase"): 80, ("start/stop", "two-phase"): 100,
        ("start/stop", "one-phase"): 50}  # fmt: skip


@pytest.fixture(scope="module")
def bench() -> Drive:
    found = drive(trochia.load("shield-bench"), 0)
    assert found is not None
    return found


def search(bench: Drive, limit: str, mode: str, timing: str) -> tuple[float, float]:
    """Return a limit, and where the first loss is, in rpm, on the sketches' own raster of whole rpm."""
    made = replace(bench.made, excitation=excitation(mode))
    speeds = (np.arange(FROM[limit, mode], 300.0) * RPM).tolist()
    if limit == "pull-out":
        found = pull_out_speed(made, speeds, bench.load, TIMINGS[timing]) / RPM
        return found, found
    held, first = start_stop_speeds(made, speeds, bench.load, TIMINGS[timing])
    return held / RPM, first / RPM


@pytest.mark.parametrize(("limit", "mode"), CASES)
def test_all_four_limits_are_within_15_percent_and_exact_timing_is_better(limit: str, mode: str, bench: Drive):
    """With one phase a motor stops by running on, whatever its pulses: there even ones save the single losses."""
    library, exact = (search(bench, limit, mode, timing) for timing in ("shield", "exact"))
    assert library[0] == pytest.approx(MEASURED[limit][mode], rel=0.15)
    which = 1 if (limit, mode) == ("start/stop", "one-phase") else 0
    assert exact[which] > library[which]


def test_the_bench_keeps_to_the_motors_list(bench: Drive):
    listed, used = motor("SM-42BYG011-25").parameters(), bench.made.motor
    assert (used.inductance, used.inertia, used.torque_constant) == (
        listed.inductance, listed.inertia, listed.torque_constant
    )  # fmt: skip
    warmer = (used.resistance / listed.resistance - 1) / 0.0039  # of copper [1/K]
    assert 0 < warmer < 50
    assert used.detent / 0.23 == pytest.approx(0.04, abs=0.02)


def test_a_comparison_says_how_fast_the_motor_turned(bench: Drive):
    """A step's own work makes 3 ms of wait 3.186 ms; exact timing turns as fast as asked."""
    slow = replace(bench.load, viscous=0.01)  # hard to turn, so the search is short
    rows = compare(bench.made, slow, top=40 * RPM)
    assert [(row.excitation, row.timing) for row in rows] == [
        (mode, timing) for mode in ("two-phase", "one-phase") for timing in ("shield", "exact")
    ]
    for row in rows:
        if row.pull_out and row.timing == "shield":
            wait = math.tau / 200 / row.pull_out
            assert row.pull_out_turned == pytest.approx(math.tau / 200 / (wait + 0.186e-3), rel=2e-3)
        elif row.pull_out:
            assert row.pull_out_turned == pytest.approx(row.pull_out)
    assert any(row.pull_out for row in rows)
