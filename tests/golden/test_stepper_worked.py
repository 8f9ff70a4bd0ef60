"""The worked numbers of a published stepper design (2015), W01 to W57: its own value, the right one, and what we make.

One row a number.  ``ours`` must be the right value; ``source`` is what was printed; ``agrees`` says whether a reader
who takes it is right: where not, the difference is held as well, so that nobody mends our value to the printed one.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import pytest

from trochia.machine.motors import motor
from trochia.pulses.ramps import Demand, TorqueCurve, profile
from trochia.pulses.ramps.austin import braking, recursion
from trochia.pulses.ramps.torque import legs
from trochia.stepper import Kept, Stepper, VirtualTime
from trochia.stepper.controller import delays, duration, plan_move

ANGLE = 0.0314  # the step angle the source calculates with [rad]
RPM = 200 / 60  # steps/s
TEETH = motor("SM-42BYG011-25").parameters().teeth


class Row(NamedTuple):
    """One worked number: what we make, the right value to how many parts, what was printed (None: nothing was)."""

    ours: float
    right: float
    close: float
    source: float | None
    agrees: bool = True


def ticks(clock: float, steps_s: float) -> float:
    return plan_move(10, steps_s * ANGLE, 100, 100, angle=ANGLE, clock=clock).shortest


def ramp(rad_s2: float, last: int) -> list[float]:
    return list(recursion(0.676e6 * math.sqrt(2 * ANGLE / rad_s2), last))


def move(rad_s2: float, up: int, brake: int, down: int, steps: int) -> list[float]:
    """The source's table: up to delay ``up``, even, ``down`` delays from step ``brake`` on [ticks]."""
    rising = ramp(rad_s2, up)
    even = float(round(rising[-1]))
    return [*rising, *[even] * (brake - up - 1), *braking(even, down)][:steps]


CURVE = TorqueCurve(speeds=(100.0, 100.0 + 1e-9, 435.0), torques=(0.35, 0.351, 0.426 - 0.00075 * 435.0))
UP = legs(Demand(steps=4000, speed=434.0, steps_per_turn=24, curve=CURVE, load=0.1, inertia=2e-4))[0]
AREA = 1 / (math.tau / 24 * 2e-4)  # of a time: what it is the integral of [1/(N·m·s²)]
PLAN, SHORT = (plan_move(steps, 19.90, 30, 30, angle=ANGLE) for steps in (600, 350))
HUNDRED = ramp(100, 70)
BOXED = move(120, 58, 158, 42, 200)
SPEED = 1e6 * ANGLE / 1492


def moved(*positions: int, speed: float = 150, acceleration: float = 1e9) -> Stepper:
    made = Stepper(Kept(), VirtualTime())
    made.set_max_speed(speed)
    made.set_acceleration(acceleration)
    for position in positions[:-1]:
        made.run_to_new_position(position)
    made.move_to(positions[-1])
    return made


def steady(steps: int, speed: float) -> float:
    made = moved(steps, speed=speed)
    made.set_speed(speed)
    while made.run_speed_to_position():
        pass
    return made.time.now


def ran(steps: int, speed: float, acceleration: float) -> float:
    made = moved(steps, speed=speed, acceleration=acceleration)
    made.run_to_position()
    return made.time.now


ROWS = {
    "W01 tooth pitch [degrees]": Row(360 / TEETH, 7.2, 1e-12, 7.2),
    "W02 offset of the discs [degrees]": Row(360 / TEETH / 2, 3.6, 1e-12, 3.6),
    "W03 step [degrees]": Row(360 / TEETH / 4, 1.8, 1e-12, 1.8),
    "W04 steps of a turn": Row(4 * TEETH, 200, 1e-12, 200),
    "W05 timer value, 400 steps/s at 16 MHz": Row(ticks(16e6, 400), 40_000, 1e-12, 40_000),
    "W06 timer value, 650 steps/s at 1 MHz": Row(ticks(1e6, 650), 1538.46, 1e-5, 1504, agrees=False),
    "W07 time of 1504 ticks [s]": Row(1504 / 1e6, 0.001504, 1e-12, 0.001504),
    "W08 ceiling of 35 us [rpm]": Row(1 / 35e-6 / RPM, 8571.4, 1e-4, 8500),
    "W09 time to 50 steps/s [ms]": Row(UP.duration(50.0) * 1e3, 0.20944 * 50, 1e-4, 0.21 * 50),
    "W10 time to 100 steps/s [ms]": Row(UP.duration(100.0) * 1e3, 20.944, 1e-4, 21),
    "W11 pull-out [steps/s]": Row(CURVE.reach(0.1), 434.67, 1e-5, 435),
    "W12 area at 400 steps/s": Row(UP.duration(400.0) * AREA, 400 + math.log(0.251 / 0.026) / 0.00075, 1e-3,
                                   400 + math.log(0.351 / 0.126) / 0.00075, agrees=False),
    "W13 area at 200 steps/s": Row(UP.duration(200.0) * AREA, 873.3, 1e-3, 720.5, agrees=False),
    "W14 timer value, 300 rpm": Row(ticks(1e6, 300 * RPM), 1000, 1e-12, 1000),
    "W15 steps/s of 20,000 ticks at 8 MHz": Row(8e6 / ticks(8e6, 400) , 400, 1e-12, 400),
    "W16 acceleration for 200 rpm in 0.2 s [rad/s2]": Row(math.radians(200 * 6) / 0.2, 104.7, 1e-3, 100, agrees=False),
    "W17 200 rpm [rad/s]": Row(math.radians(200 * 6), 20.944, 1e-4, 20.9),
    "W18 first delay": Row(HUNDRED[0], 16940.5, 1e-5, 16941),
    "W19 second delay": Row(HUNDRED[1], 10164.3, 1e-5, 10164),
    "W20 shortest delay": Row(HUNDRED[70], 1492.34, 1e-5, 1492),
    "W21 steps to pull-out": Row(20.944**2 / (2 * ANGLE * 100), 69.85, 1e-3, 70),
    "W22 time to pull-out [s]": Row(sum(HUNDRED) / 1e6, 0.202697, 1e-5, 0.2027),
    "W23 braking begins at": Row(plan_move(400, SPEED, 100, 100, angle=ANGLE).brakes_at, 330, 1e-12, 330),
    "W24 acceleration for 53 steps [rad/s2]": Row(70 * 100 / plan_move(400, SPEED, 132.1, 132.1, angle=ANGLE).rising,
                                                  132.1, 1e-3, 130),
    "W25 braking at 200 rad/s2": Row(-plan_move(400, SPEED, 100, 200, angle=ANGLE).braking, 35, 1e-12, 35),
    "W26 ramp at 130 rad/s2": Row(70 * 100 / 130, 53.8, 1e-3, 58, agrees=False),
    "W27 braking of a ramp of 58 begins at": Row(200 - round(70 * 100 / 120), 142, 1e-12, 142),
    "W28 time of row 142 with 130 rad/s2 [s]": Row(sum(move(130, 53, 142, 53, 143)) / 1e6, 0.2878, 2e-3, 0.2937,
                                                    agrees=False),
    "W28 time of row 142 with 120 rad/s2 [s]": Row(sum(move(120, 58, 142, 58, 143)) / 1e6, 0.2937, 1e-3, 0.2937),
    "W29 time left [s]": Row(0.42 - 0.2937, 0.1263, 1e-3, 0.1163, agrees=False),
    "W30 braking for it [rad/s2]": Row(21 / 0.1163, 180.6, 1e-3, 181),
    "W31 its steps": Row(58 * 130 / 181, 41.66, 1e-3, 42),
    "W32 it begins at": Row(200 - 42, 158, 1e-12, 158),
    "W33 speed at step 198 [rpm]": Row(60e6 / (200 * BOXED[198]), 37.9, 1e-2, 38),
    "W33 speed at step 199 [rpm]": Row(60e6 / (200 * BOXED[199]), 22.8, 1e-2, 23),
    "W34 total [s]": Row(sum(BOXED) / 1e6, 0.4359, 2e-4, 0.44),
    "W36 interval of the theory at step 53 [ms]": Row(ramp(100, 53)[52] / 1e3, 1.729, 2e-2, 1.73),
    "W37 speed at step 53 [steps/s]": Row(1e6 / ramp(100, 53)[53], 583.8, 2e-3, 584),
    "W38 190 rpm [steps/s]": Row(190 * RPM, 633.3, 1e-4, 634),
    "W39 demonstration: c": Row(PLAN.shortest, 1577.89, 1e-5, None),
    "W40 demonstration: c0": Row(PLAN.first, 30929.0, 1e-5, None),
    "W41 demonstration: n": Row(PLAN.rising, 210, 1e-12, None),
    "W42 demonstration: n1": Row(PLAN.limit, 300, 1e-12, 300),
    "W43 demonstration: n2": Row(PLAN.braking, -210, 1e-12, -300, agrees=False),
    "W44 short move: n2": Row(SHORT.braking, -175, 1e-12, None),
    "W44 short move: peak [steps/s]": Row(1e6 / min(delays(SHORT)), 577.4, 1e-3, 579),
    "W45 400 steps/s at 1 MHz": Row(ticks(1e6, 400), 2500, 1e-12, 2500),
    "W46 500, then 200": Row(moved(500, 200).distance_to_go(), -300, 1e-12, -300),
    "W47 500, then 550": Row(moved(500, 550).distance_to_go(), 50, 1e-12, 50),
    "W48 1800 steps at 150 steps/s [s]": Row(steady(1800, 150), 12.0, 1e-9, None),
    "W49 150 steps/s [rpm]": Row(150 / RPM, 45, 1e-12, 45),
    "W50 2000 steps, 600, 1500 [s]": Row(ran(2000, 600, 1500), 3.733, 1e-4, None),
    "W51 whole move [s]": Row(sum(move(100, 70, 330, 70, 400)) / 1e6, 0.790282, 1e-6, 0.79),
    "W53 with 200 rad/s2, 35 up and 33 down [s]": Row(sum(move(200, 35, 367, 33, 400)) / 1e6, 0.68560, 1e-4, 0.6856),
    "W53 with 35 both ways [s]": Row(sum(move(200, 35, 365, 35, 400)) / 1e6, 0.6884, 1e-4, 0.6856),
    "W54 braking at 200 rad/s2": Row(plan_move(400, SPEED, 200, 200, angle=ANGLE).rising, 35, 1e-12, 34, agrees=False),
    "W55 pull-out, both phases [steps/s]": Row(200 * RPM, 666.7, 1e-4, None),
    "W56 start/stop, one phase [steps/s]": Row(100 * RPM, 333.3, 1e-3, None),
    "W57 S450A300D800S [s]": Row(ran(800, 450, 300), 3.278, 1e-3, None),
}  # fmt: skip


@pytest.mark.parametrize("name", ROWS)
def test_worked_number(name: str):
    row = ROWS[name]
    assert row.ours == pytest.approx(row.right, rel=row.close)
    if row.source is not None:
        assert (row.source == pytest.approx(row.right, rel=0.02)) == row.agrees


@pytest.mark.parametrize(
    ("total", "wanted", "printed", "right"),
    [(BOXED, 0.42, False, True), (move(100, 70, 330, 70, 400), 0.7, False, False)],
)
def test_verdicts(total: list[float], wanted: float, *, printed: bool, right: bool):
    """W35: 0.436 s is within 0.42 s ± 5 %, though the source says it fails; W52: 0.79 s is not within 0.7 s ± 5 %."""
    meets = abs(sum(total) / 1e6 - wanted) <= 0.05 * wanted
    assert meets == right
    assert (meets == printed) == (wanted == 0.7)


def test_every_number_has_its_row():
    assert {name[:3] for name in ROWS} | {"W35", "W52"} == {f"W{n:02}" for n in range(1, 58)}
    assert duration(PLAN) == pytest.approx(1.57963, abs=5e-6)
    assert profile(Demand(steps=400, speed=1e6 / 1492, acceleration=100 / ANGLE), "austin").duration == pytest.approx(
        ROWS["W51 whole move [s]"].ours, abs=1e-9
    )
