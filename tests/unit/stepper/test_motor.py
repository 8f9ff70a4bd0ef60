"""The step library against closed forms: exact ramps, targets changed in motion, arrival together."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import LimitError
from trochia.pulses.ramps import Demand, profile
from trochia.stepper import Kept, Stepper, StepperGroup, VirtualTime

moves = st.tuples(st.integers(1, 300), st.floats(1, 1000), st.floats(1, 5000), st.floats(1, 5000))


def motor(speed: float = 600, up: float = 1500, down: float | None = None) -> tuple[Stepper, Kept]:
    kept = Kept()
    made = Stepper(kept, VirtualTime())
    made.set_max_speed(speed)
    made.set_acceleration(up, down)
    return made, kept


@given(moves)
def test_a_move_is_the_exact_law(given_move: tuple[int, float, float, float]):
    steps, speed, up, down = given_move
    made, kept = motor(speed, up, down)
    made.run_to_new_position(-steps)
    exact = profile(Demand(steps=steps, speed=speed, acceleration=up, deceleration=down))
    assert np.array(kept.moments) == pytest.approx(exact.times, rel=1e-9)
    assert set(kept.directions) == {-1}
    assert made.current_position() == -steps
    assert not made.is_running()
    assert made.speed() == 0


def test_targets_are_absolute_and_moves_relative():
    made, _ = motor()
    made.set_current_position(500)
    made.move_to(200)
    assert made.distance_to_go() == -300
    made.move_to(550)
    assert made.distance_to_go() == 50
    made.move(-10)
    assert made.target_position() == 490


def test_run_makes_one_step_at_most():
    made, kept = motor()
    made.move(3)
    seen = []
    while made.run():
        seen.append(len(kept.moments))
    assert all(after - before <= 1 for before, after in pairwise(seen))
    assert len(kept.moments) == 3
    assert not made.run()


def test_stop_brakes_as_hard_as_it_may_and_no_harder():
    made, kept = motor(600, 1500)
    made.move(10_000)
    while made.current_position() < 400:
        made.run()
    made.stop()
    assert made.target_position() == 400 + math.ceil(600**2 / (2 * 1500))
    made.run_to_position()
    late = np.diff(kept.moments)[400:]
    assert (np.diff(late) > -1e-9).all()
    assert made.current_position() == 520


@given(st.integers(-200, 200), st.integers(0, 200))
def test_a_target_behind_is_reached_by_braking_first(target: int, at: int):
    """The speed's square never changes by more than 2 a a step, whatever the target does."""
    made, kept = motor(400, 900)
    made.move(10_000)
    while made.current_position() < at:
        made.run()
    made.move_to(target)
    made.run_to_position()
    assert made.current_position() == target
    speeds = np.array(kept.directions[1:]) / np.maximum(np.diff(kept.moments), 1e-12)
    assert np.abs(speeds).max(initial=0) <= 400 * (1 + 1e-9)
    assert (np.diff(kept.moments) > 0).all()


def test_constant_speed_and_its_position():
    made, kept = motor(150)
    made.set_speed(-150)
    while made.time.now < 1.0:
        made.run_speed()
    assert made.current_position() == pytest.approx(-150, abs=1)
    assert np.diff(kept.moments) == pytest.approx(1 / 150)
    made.move_to(20)
    while made.run_speed_to_position():
        pass
    assert made.current_position() == 20
    assert made.speed() == 150


def test_a_speed_is_limited_and_zero_stands_still():
    made, kept = motor(100)
    made.set_speed(-900)
    assert made.speed() == -100
    made.set_speed(0)
    assert not made.run_speed()
    assert not kept.moments


def test_limits_may_change_in_motion():
    made, kept = motor(200, 1000)
    made.move(400)
    while made.current_position() < 100:
        made.run()
    made.set_max_speed(500)
    while made.current_position() < 250:
        made.run()
    assert made.speed() == pytest.approx(500)
    made.set_max_speed(100)
    made.run_to_position()
    assert made.current_position() == 400
    assert np.abs(np.diff(1 / np.diff(kept.moments) ** 2)).max() < 2 * 2 * 1000


def test_figures_that_cannot_be_are_refused():
    made, _ = motor()
    for refused in (made.set_max_speed, made.set_acceleration):
        with pytest.raises(LimitError, match="more than 0"):
            refused(0)
    with pytest.raises(LimitError, match="number"):
        made.set_speed(math.nan)
    with pytest.raises(LimitError, match="share one time"):
        StepperGroup(made, motor()[0])
    with pytest.raises(LimitError, match="as many targets"):
        StepperGroup(made).move_to([1, 2])


def test_starts_beyond_the_motor_are_refused():
    """√(2/a) is the first step's time: 170 rpm are 566.7 steps/s, so 642,222 steps/s² would do and no more."""
    made, kept = motor(2000, 700_000)
    made.set_start_stop_speed(170 * 200 / 60)
    made.move(100)
    with pytest.raises(LimitError, match=r"591\.6 steps/s.*566\.667") as refused:
        made.run()
    assert "6.422e+05" in str(refused.value.hint)
    made.set_acceleration(642_000)
    made.run_to_position()
    assert 1 / kept.moments[0] < 170 * 200 / 60
    made.set_speed(600)
    with pytest.raises(LimitError, match="600 steps/s from rest"):
        made.run_speed()
    made.set_speed(560)
    made.run_speed()


@pytest.mark.parametrize("wrong", [1.5, math.nan, math.inf, "12", None, True, 10**30])
def test_positions_are_whole_numbers(wrong: Any):
    made, _ = motor()
    for take in (made.move_to, made.move, made.set_current_position, made.run_to_new_position):
        with pytest.raises(LimitError, match=r"whole number|within ±9007199254740992"):
            take(wrong)
    assert (made.target_position(), made.current_position()) == (0, 0)
    made.move_to(np.int64(3))
    made.move(2.0)  # type: ignore[arg-type]
    assert made.target_position() == 2


@pytest.mark.parametrize("wrong", [0, -5, math.nan, math.inf, "fast", None, 1e300, 1e-320])
def test_limits_are_quantities(wrong: Any):
    made, _ = motor(500, 900)
    for take in (made.set_max_speed, made.set_acceleration, made.set_start_stop_speed):
        with pytest.raises(LimitError, match=r"more than 0|a number of|from 1e-06 to"):
            take(wrong)
    with pytest.raises(LimitError, match="deceleration"):
        made.set_acceleration(100, wrong if wrong is not None else 0)
    assert (made.max_speed(), made.acceleration(), made.deceleration()) == (500, 900, 900)


def test_a_ramp_goes_on_from_constant_speed():
    """From 100 steps/s the way to 500 is (500² - 100²)/(2 a) = 120 steps, and no step is later than the one before."""
    made, kept = motor(500, 1000)
    made.set_speed(100)
    while made.current_position() < 50:
        made.set_speed(100)  # as sketches do, each time round
        made.run_speed()
    made.move_to(400)
    while made.speed() < 500 - 1e-9:
        made.run()
    assert made.current_position() == 50 + 120
    assert (np.diff(kept.moments)[:170] <= 0.01 + 1e-9).all()
    made.run_to_position()
    made.set_speed(-100)
    while made.current_position() > 390:
        made.run_speed()
    made.stop()
    assert made.target_position() == 390 - 5
    made.run_to_position()
    assert made.current_position() == 385


def test_constant_speed_that_was_left_stands():
    made, kept = motor(500, 1000)
    made.set_speed(500)
    while made.current_position() < 3:
        made.run_speed()
    made.time.wait_until(1.0)
    made.run_to_new_position(10)
    assert kept.moments[3] == pytest.approx(1 + math.sqrt(2 / 1000))


def test_a_motor_that_nobody_runs_holds_up_no_other():
    time = VirtualTime()
    (left, _), (run, kept) = [(Stepper(out, time), out) for out in (Kept(), Kept())]
    for made in (left, run):
        made.set_max_speed(500)
        made.set_acceleration(1000)
    left.move(100)
    while left.current_position() < 9:
        left.run()
    before = time.now
    run.run_to_new_position(50)
    assert kept.moments[-1] - before == pytest.approx(2 * math.sqrt(50 / 1000))
    resumed = time.now
    left.run_to_position()
    moments = np.array(left.output.moments)  # type: ignore[attr-defined]
    assert (np.diff(moments) > 0).all()
    assert moments[9] - resumed == pytest.approx(math.sqrt(2 / 1000))  # from rest again: it had stood


def test_several_motors_in_turn_are_as_exact_as_alone():
    time = VirtualTime()
    outputs = [Kept() for _ in range(3)]
    motors = [Stepper(output, time) for output in outputs]
    for i, made in enumerate(motors):
        made.set_max_speed(200 + 100 * i)
        made.set_acceleration(900)
        made.move(100 + 50 * i)
    while any([made.run() for made in motors]):  # noqa: C419 - every motor must be asked
        pass
    for i, output in enumerate(outputs):
        exact = profile(Demand(steps=100 + 50 * i, speed=200 + 100 * i, acceleration=900))
        assert np.array(output.moments) == pytest.approx(exact.times, rel=1e-9)


def test_a_group_takes_limits_as_they_are_and_gives_them_back():
    time = VirtualTime()
    one, two = Stepper(Kept(), time), Stepper(Kept(), time)
    group = StepperGroup(one, two)
    for made in (one, two):
        made.set_max_speed(500)
        made.set_acceleration(1000)
    one.set_max_speed(100)
    group.move_to([100, 50])
    assert two.max_speed() == pytest.approx(50)
    group.run_to_position()
    assert (one.max_speed(), two.max_speed()) == (100, 500)
    assert time.now == pytest.approx(100 / 100 + 100 / 1000)
    group.move_to([1000, 900])
    while one.current_position() < 300:
        group.run()
    with pytest.raises(LimitError, match="from rest"):
        group.move_to([0, 0])
    group.stop()
    group.run_to_position()
    assert one.current_position() < 1000
    with pytest.raises(LimitError, match="whole number"):
        group.move_to([1.5, 0])  # type: ignore[list-item]
    assert two.max_speed() == 500


def test_outputs_are_switched():
    made, kept = motor()
    made.enable_outputs()
    made.disable_outputs()
    assert kept.switched == [(0.0, True), (0.0, False)]


@given(st.lists(st.integers(-300, 300), min_size=1, max_size=4).filter(any))
def test_a_group_arrives_together(targets: list[int]):
    time = VirtualTime()
    outputs = [Kept() for _ in targets]
    motors = [Stepper(output, time) for output in outputs]
    for i, made in enumerate(motors):
        made.set_max_speed(100 + 70 * i)
        made.set_acceleration(500 + 300 * i, 700)
    group = StepperGroup(*motors)
    group.move_to(targets)
    group.run_to_position()
    assert [made.current_position() for made in motors] == targets
    ends = [output.moments[-1] for output in outputs if output.moments]
    assert ends == pytest.approx([ends[0]] * len(ends), rel=1e-9)
    for made, output in zip(motors, outputs, strict=True):
        group.release_limits()
        if len(output.moments) > 1:
            assert (1 / np.diff(output.moments)).max() <= made.max_speed() * (1 + 1e-9)
