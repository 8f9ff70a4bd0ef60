"""Printed and worked stepper profiles of a published design (2015), reproduced to the last printed digit.

Printed rows: 1 MHz clock, 200 steps a turn, 100 rad/s² with a step angle taken as 0.0314, 400 steps, 70 up and 70 down,
a plateau of 1492 ticks.  Where the source is wrong both values stand here: its own, and the right one that is built.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from trochia.pulses.ramps import Demand, TorqueCurve, profile
from trochia.pulses.ramps.austin import braking, recursion
from trochia.pulses.ramps.library import next_speed
from trochia.pulses.ramps.torque import legs

HERE = Path(__file__).parent / "stepper"
ANGLE = 0.0314  # the step angle the source calculates with [rad]


def rows(name: str) -> list[dict[str, str]]:
    with (HERE / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def demand(steps: int, ticks: float, rad_s2: float) -> Demand:
    return Demand(steps=steps, speed=1e6 / ticks, acceleration=rad_s2 / ANGLE)


def test_every_printed_row():
    printed = rows("printed-profile.csv")
    table = profile(demand(400, 1492, 100), "austin").columns()
    artefacts = [row for row in printed if row["n"] == "400"]
    assert (len(printed), len(artefacts), table["n"].size) == (416, 2, 400)  # a 401st delay is negative, and never made
    for row in printed:
        n = int(row["n"])
        if n == 400:
            continue
        digits = len(row["time_s"].partition(".")[2])
        half = 0.5 * 10.0**-digits + 1e-9
        assert table["time_s"][n] == pytest.approx(float(row["time_s"]), abs=half)
        assert table["delay_s"][n] == pytest.approx(float(row["delay_s"]), abs=0.5e-5 + 1e-9)
        assert table["elapsed_ticks"][n] == pytest.approx(int(row["elapsed_ticks"]), abs=0.5)
        assert table["ticks"][n] == pytest.approx(int(row["ticks"]), abs=0.5)
        assert round(float(table["speed_rpm"][n])) == int(row["rpm"])
        assert round(float(table["speed_steps_s"][n])) == int(row["steps_s"])
        # the source divides rpm by 9.55 in place of 30/pi
        assert table["speed_rpm"][n] / 9.55 == pytest.approx(float(row["rad_s"]), abs=0.5e-3 + 1e-9)
        assert table["speed_rad_s"][n] == pytest.approx(float(row["rad_s"]), abs=0.5e-3 + 1e-4 * float(row["rad_s"]))


def test_accelerations_found_back():
    found = profile(demand(400, 1492, 100), "austin").accelerations * ANGLE
    for row in rows("acceleration-found-back.csv"):
        assert found[int(row["n"]) - 1] == pytest.approx(float(row["rad_s2"]), abs=0.0051)


def test_anchors_of_the_printed_move():
    made = profile(demand(400, 1492, 100), "austin")
    assert np.round(made.delays[[0, 1, 2, 3, 10, 69, 70, 330, 398, 399]] * 1e6).tolist() == [
        16941, 10164, 7906, 6689, 3866, 1503, 1492, 1503, 10162, 16937,
    ]  # fmt: skip
    assert made.duration == pytest.approx(0.790282, abs=5e-7)
    assert made.times[[0, 10, 50, 69, 70]] == pytest.approx([0.01694, 0.07466, 0.17050, 0.20120, 0.20270], abs=5.1e-6)


def test_twice_the_acceleration():
    up = recursion(0.676e6 * math.sqrt(2 * ANGLE / 200), 35)
    plateau = float(round(up[-1]))
    printed = up.sum() + plateau * (367 - 36) + braking(plateau, 33).sum()  # as printed: 35 up, 33 down, one delay less
    assert printed / 1e6 == pytest.approx(0.6856, abs=0.0015)
    made = profile(demand(400, plateau, 200), "austin")
    assert made.duration == pytest.approx(0.6884, abs=5e-5)  # 35 up and 35 down, as n1 a1 = n2 a2 has it


@pytest.mark.parametrize(("steps", "total", "at"), [(350, 1.18131, 174), (600, 1.57963, 210)])
def test_short_and_long_move_of_the_controller(steps: int, total: float, at: int):
    made = profile(demand(steps, 1577.89, 30), "austin")
    assert made.duration == pytest.approx(total, abs=5e-6)
    assert int(np.argmin(made.delays)) == at
    if steps == 350:
        assert made.delays.min() * 1e6 == pytest.approx(1731.83, abs=0.005)
    else:
        assert made.delays[389] == made.delays[210] < made.delays[390]  # the text's 300 steps would brake at 300


def example() -> Demand:
    curve = TorqueCurve(speeds=(100.0, 100.0 + 1e-9, 435.0), torques=(0.35, 0.351, 0.426 - 0.00075 * 435.0))
    return Demand(steps=4000, speed=434.0, steps_per_turn=24, curve=curve, load=0.1, inertia=2e-4)


def test_torque_limited_times_both_ways():
    up, _ = legs(example())
    printed = rows("torque-limited.csv")
    scale = 1e3 * example().step_angle * 2e-4
    for row in printed:
        speed = float(row["speed_steps_s"])
        assert up.duration(speed) * 1e3 == pytest.approx(float(row["time_ms"]), abs=2e-4)
        if speed > 100:  # the source: the load left out above the knee
            without = 400.0 + math.log(0.351 / (0.426 - 0.00075 * speed)) / 0.00075
            assert scale * without == pytest.approx(float(row["time_ms_without_load"]), abs=1e-4)
    assert up.duration(100.0) * 1e3 == pytest.approx(20.94, abs=0.005)
    assert up.duration(200.0) * 1e3 == pytest.approx(45.73, abs=0.005)  # the source's form gives 37.73
    assert example().curve.reach(0.1) == pytest.approx(434.67, abs=0.005)


def test_time_box_ends_in_time():
    """200 steps in 0.42 s: the source's 42 braking steps end late; about 31 (225 rad/s²) do not."""
    up = recursion(0.676e6 * math.sqrt(2 * ANGLE / 120), 58)
    plateau = float(round(up[-1]))
    late = up.sum() + plateau * (158 - 59) + braking(plateau, 42).sum()
    assert plateau == 1496
    assert late / 1e6 == pytest.approx(0.4359, abs=5e-5)
    made = profile(demand(200, plateau, 120), "austin", time_box=0.42)
    assert made.duration == pytest.approx(0.42, abs=0.001)
    assert made.demand.falling * ANGLE == pytest.approx(225, rel=0.04)
    assert 200 - int(np.flatnonzero(made.delays <= made.delays.min() * (1 + 1e-9))[-1]) - 1 == pytest.approx(31, abs=1)


@pytest.mark.parametrize(
    ("given", "expected"),
    [((800, 450.0, 300.0), (336, 464, 3.122)), ((2000, 600.0, 1500.0), (119, 1882, 3.662))],
)
def test_library_rule(given: tuple[int, float, float], expected: tuple[int, int, float]):
    (steps, speed, acceleration), (first, brake, total) = given, expected
    made = profile(Demand(steps=steps, speed=speed, acceleration=acceleration), "library")
    held = np.flatnonzero(made.speeds == speed)
    assert (held[0] + 1, held[-1] + 2) == (first, brake)
    assert made.duration == pytest.approx(total, abs=5e-4)


def test_library_rule_from_a_given_speed():
    speed, time, times, speeds = 30.0, 0.0, [], []
    for done in range(200):
        # the report counts both ends: at round i there are 400 - i steps to go
        speed = next_speed(speed, 400 - done, 3000.0, 3000.0, 650.0)
        time += 1.0 / speed
        times.append(1e3 * time)
        speeds.append(speed)
    assert times[:5] == pytest.approx([7.69, 14.22, 20.02, 25.28, 30.14], abs=0.0051)
    assert speeds.index(650.0) + 1 == 68
    assert times[-1] == pytest.approx(378.300, abs=5e-4)
