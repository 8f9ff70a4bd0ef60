"""The speed controller and the library's names against the figures of a published design (2015).

Where the source is wrong both values stand here: its own, and the right one that is built.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from trochia.errors import LimitError
from trochia.kernels.ticks import speed_move
from trochia.pulses.ramps import Demand, profile
from trochia.pulses.ramps.austin import recursion
from trochia.pulses.ramps.library import next_speed
from trochia.stepper import Kept, Stepper, VirtualTime
from trochia.stepper.controller import MovePlan, SpeedController, State, delays, duration, plan_move

ANGLE = 0.0314  # the step angle the source calculates with [rad]
HERE = Path(__file__).parent / "stepper"
RPM = 200 / 60  # steps/s of a motor of 200 steps a turn


def test_the_printed_move_step_by_step():
    """The state machine makes the table's 400 delays, 0.790282 s, and no 401st."""
    first = 0.676e6 * math.sqrt(2 * ANGLE / 100)
    made = delays(MovePlan(steps=400, shortest=1492, first=first, rising=70, limit=200, braking=-70))
    expected = profile(Demand(steps=400, speed=1e6 / 1492, acceleration=100 / ANGLE), "austin").delays * 1e6
    assert made == pytest.approx(expected, rel=1e-9)
    assert sum(made) / 1e6 == pytest.approx(0.790282, abs=5e-7)


def test_demonstration_move():
    plan = plan_move(600, 19.90, 30, 30, angle=ANGLE)
    assert (plan.rising, plan.limit, plan.braking, plan.brakes_at) == (210, 300, -210, 390)  # the text's n2 is -300
    assert plan.shortest == pytest.approx(1577.89, abs=0.005)
    assert plan.first == pytest.approx(30929.00, abs=0.05)
    assert duration(plan) == pytest.approx(1.57963, abs=5e-6)
    made = delays(plan)
    assert made[1] == pytest.approx(18557.4, abs=0.05)  # the source's listing begins with this one
    assert sum(made[1:]) / 1e6 == pytest.approx(1.550, abs=0.0015)
    assert made[209] == pytest.approx(1579, abs=3)


def test_short_move():
    plan = plan_move(350, 19.90, 30, 30, angle=ANGLE)
    assert (plan.limit, plan.braking) == (175, -175)
    made = delays(plan)
    assert (len(made), int(np.argmin(made))) == (350, 174)
    assert min(made) == pytest.approx(1731.83, abs=0.005)
    assert 60e6 / (200 * min(made)) == pytest.approx(173.2, abs=0.6)  # the source: 173.7 rpm
    assert duration(plan) == pytest.approx(1.18131, abs=5e-6)


def test_states_follow_each_other():
    controller = SpeedController(plan_move(600, 19.90, 30, 30, angle=ANGLE))
    controller.begin()
    seen = [controller.state]
    while controller.interrupt() is not None:
        seen.append(controller.state)
    borders = [i for i in range(1, 600) if seen[i] is not seen[i - 1]]
    assert [seen[i] for i in (0, *borders)] == [State.ACCEL, State.RUN, State.DECEL]
    assert borders == [210, 390]
    assert controller.state is State.STOP
    assert controller.count == 600


@pytest.mark.parametrize(
    ("clock", "steps_s", "ticks", "printed"),
    [(16e6, 400, 40_000, 40_000), (1e6, 300 * RPM, 1000, 1000), (1e6, 400, 2500, 2500), (8e6, 400, 20_000, 20_000),
     (1e6, 650, 1538.46, 1504)],
)  # fmt: skip
def test_timer_values(clock: float, steps_s: float, ticks: float, printed: float):
    """The last is the source's slip: 1504 ticks are 664.9 steps/s."""
    plan = plan_move(10, steps_s * ANGLE, 100, 100, angle=ANGLE, clock=clock)
    assert plan.shortest == pytest.approx(ticks, abs=0.005)
    if printed != ticks:
        assert 1e6 / printed == pytest.approx(664.9, abs=0.05)
    _, states = speed_move(10**6, 10**6, (1, 3, 1), round(plan.shortest * 256))
    assert states.size == 5


def test_the_first_delay_must_fit_the_timer():
    """16 bits at 1 MHz hold 15.3 steps/s and more: fine for 30 rad/s²; the board's own 16 MHz is not."""
    assert plan_move(600, 19.90, 30, 30, angle=ANGLE, register=16).first < 2**16
    with pytest.raises(LimitError, match="494864 ticks, and a register of 16 bits holds 65535") as refused:
        plan_move(600, 19.90, 30, 30, angle=ANGLE, clock=16e6, register=16)
    assert "2.11889e+06 Hz" in str(refused.value.hint)
    assert plan_move(600, 19.90, 30, 30, angle=ANGLE, clock=2e6, register=16).first < 2**16  # 16 MHz by 8


def test_speed_of_a_timer_value():
    """20,000 ticks at 8 MHz: 400 steps/s, 120 rpm, 12.56 rad/s."""
    table = profile(Demand(steps=4, speed=400, acceleration=1e9, clock=8e6), "exact").columns()
    assert table["ticks"][2] == pytest.approx(20_000, rel=1e-6)
    assert table["speed_rpm"][2] == pytest.approx(120, rel=1e-6)
    assert table["speed_rad_s"][2] == pytest.approx(12.56, abs=0.01)


def test_other_ramp_lengths_for_one_speed():
    """n a is the same: braking with 200 rad/s² takes 35 steps; 53 steps want 132.1 rad/s², where the source has 130."""
    speed = 1e6 * ANGLE / 1492
    plan = plan_move(400, speed, 100, 200, angle=ANGLE)
    assert (plan.rising, plan.braking) == (70, -35)
    assert plan_move(400, speed, 132.1, 132.1, angle=ANGLE).rising == 53
    assert plan_move(400, speed, 130, 130, angle=ANGLE).rising == 54


def rows(name: str) -> list[dict[str, str]]:
    with (HERE / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_error_of_the_recursion():
    """Its ratio against the square roots': 45 % at the first step, 1.4 % at the second, 0.01 % at the tenth."""
    made = recursion(1.0, 100)
    exact = profile(Demand(steps=100, speed=1e6, acceleration=1.0, deceleration=1e6), "exact").delays
    for row in rows("recursion-error.csv"):
        n, ratio = int(row["n"]), float(row["ratio"])
        assert made[n] / made[n - 1] == pytest.approx(ratio, abs=1e-8)
        error = float(row["error_percent"])
        if n < 98:  # the move itself brakes at its end
            assert exact[n] / exact[n - 1] == pytest.approx(float(row["exact_ratio"]), abs=2e-6)
            assert 100 * (ratio / (exact[n] / exact[n - 1]) - 1) == pytest.approx(error, abs=2e-3)


def test_library_rule_row_by_row():
    table = rows("library-ramp.csv")
    assert len(table) == 245
    for steps in (2000, 3000, 800):
        own = [row for row in table if row["steps"] == str(steps)]
        speed, acceleration = (float(own[0][name]) for name in ("max_steps_s", "acceleration_steps_s2"))
        made = profile(Demand(steps=steps, speed=speed, acceleration=acceleration), "library")
        for row in own:
            step = int(row["step"]) - 1
            assert made.times[step] * 1e3 == pytest.approx(float(row["time_ms"]), abs=1e-3)
            assert made.speeds[step] == pytest.approx(float(row["speed_steps_s"]), rel=1e-5)


def test_controllers_own_report():
    """From row 46 on the source prints the time two rows on (142.08 in place of 138.43 ms); the speeds are right."""
    theory = profile(Demand(steps=400, speed=1e6 / 1492, acceleration=100 / ANGLE), "austin")
    speed, time = next_speed(30.0, 400, 3000.0, 3000.0, 650.0), 0.0
    for row in rows("controller-report.csv"):
        step = int(row["step"])
        assert theory.times[step] * 1e3 == pytest.approx(float(row["theory_time_ms"]), abs=0.0051)
        if step != 68:  # the source repeats the speed of the row before
            assert theory.speeds[step] == pytest.approx(float(row["theory_steps_s"]), abs=0.51)
        if step:
            time += 1e3 / speed
            speed = next_speed(speed, 400 - step, 3000.0, 3000.0, 650.0)
            shift = float(row["printed_time_ms"]) - time
            assert shift == pytest.approx(0 if step < 46 else 3.6, abs=0.65)
        assert time == pytest.approx(float(row["time_ms"]), abs=1e-3)
        assert speed == pytest.approx(float(row["steps_s"]), abs=1e-3)
        assert speed == pytest.approx(float(row["printed_steps_s"]), abs=1.1)


def motor(speed: float, acceleration: float) -> tuple[Stepper, Kept]:
    kept = Kept()
    made = Stepper(kept, VirtualTime())
    made.set_max_speed(speed)
    made.set_acceleration(acceleration)
    return made, kept


@pytest.mark.parametrize(
    ("given", "ideal", "rule"),
    [((2000, 600, 1500), 3.733, 3.662), ((800, 450, 300), 3.278, 3.122)],
)
def test_moves_of_the_sketches(given: tuple[int, float, float], ideal: float, rule: float):
    """Constant acceleration takes the closed form's time; the source's rule is quicker by half the first delay."""
    steps, speed, acceleration = given
    made, kept = motor(speed, acceleration)
    made.run_to_new_position(steps)
    assert kept.moments[-1] == pytest.approx(ideal, abs=5e-4)
    by_rule = profile(Demand(steps=steps, speed=speed, acceleration=acceleration), "library")
    assert by_rule.duration == pytest.approx(rule, abs=5e-4)


def test_a_ramp_that_never_gets_there():
    """3000 steps/s with 300 steps/s² in 3000 steps: it takes 15,000; the peak is 949 steps/s, 285 rpm."""
    made, kept = motor(3000, 300)
    made.run_to_new_position(3000)
    peak = 1 / np.diff(kept.moments).min()
    assert peak == pytest.approx(math.sqrt(3000 * 300), rel=1e-3)
    assert peak / RPM == pytest.approx(285, abs=0.5)
