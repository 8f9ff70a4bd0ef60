"""A stepper behind its driver: two levels that agree, release, hold current, power-up, lost steps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.stability import growth_rate
from trochia.backends.stepper_twin import MEAN, SWITCHED, Levels, StepperRun, StepperTwin
from trochia.machine.drivers import Chopper, HBridge, fed
from trochia.machine.motors import ShaftLoad, motor

BIG = motor("QSH5718-55").parameters()
LOAD = ShaftLoad(inertia=2e-5, friction=0.03, constant=0.1, viscous=8e-3)


def ramp(steps: int, speed: float, acceleration: float, begin: float) -> np.ndarray:
    """Pulses of a linear ramp up to a speed, and on at it."""
    n = np.arange(1, steps + 1)
    rise = speed * speed / (2 * acceleration)
    return begin + np.where(n < rise, np.sqrt(2 * n / acceleration), speed / acceleration + (n - rise) / speed)


@pytest.mark.parametrize("decay", ["slow", "mixed", "fast"])
@pytest.mark.parametrize(("microsteps", "speed"), [(1, 400), (16, 100), (16, 1000), (16, 2000)])
def test_the_two_levels_agree(decay: str, microsteps: int, speed: float):
    """From a start through a ramp, up to 98 % of pull-out: load angle, currents and torque of both models."""
    mode = "two-phase" if microsteps == 1 else None
    made = fed(BIG, Chopper(supply=24.0, current=2.0, decay=decay, excitation=mode), microsteps)
    runs: list[StepperRun] = []
    for levels in (MEAN, SWITCHED):
        load = replace(LOAD, constant=0.05, viscous=8e-3 if microsteps == 1 else 4e-3)
        twin = StepperTwin(made, load, levels=levels)
        twin.run(0.05)
        end = speed / 3000 + 0.1
        twin.queue(ramp(int(speed * microsteps * end), speed * microsteps, 3000.0 * microsteps, twin.now))
        runs.append(twin.run(end, every=5))
        assert runs[-1].lost_steps[-1] == 0
    mean, switched = runs
    apart = np.degrees(np.sqrt(np.mean((mean.load_angle - switched.load_angle) ** 2)))
    assert apart < (6 if microsteps == 1 else 3)
    late = slice(-500, None)
    lengths = [np.hypot(*run.currents[late].T).mean() for run in runs]
    assert lengths[0] == pytest.approx(lengths[1], rel=0.04)
    torques = [made.motor.torque(run.currents[late], run.theta[late]).mean() for run in runs]
    assert torques[0] == pytest.approx(torques[1], rel=0.06)


def test_only_sharp_stretches_are_done_switch_by_switch():
    made = fed(BIG, Chopper(supply=24.0, current=2.0), 16)
    easy, hard = StepperTwin(made), StepperTwin(made)
    for twin, torques in ((easy, (0.05,)), (hard, (0.15, 0.25, 0.35, 0.38, 0.41))):
        for torque in torques:  # of 0.46 N·m
            twin.set_load(ShaftLoad(constant=torque, viscous=5e-3))
            run = twin.run(0.2)
        assert run.lost_steps[-1] == 0
    assert easy.switched == 0
    assert 0.15 < hard.switched < 0.5


def test_beyond_the_holding_torque_it_slips_by_whole_turns_of_the_field():
    made = fed(BIG, Chopper(supply=24.0, current=2.0), 16)
    twin = StepperTwin(made, ShaftLoad(constant=1.1 * made.holding))
    run = twin.run(0.05)
    assert run.lost_steps[-1] >= 4
    twin.set_load(ShaftLoad(viscous=0.02))
    rest = twin.run(0.5)
    lost = rest.lost_steps[-1]
    assert lost % 4 == 0
    assert made.motor.teeth * rest.theta[-1] == pytest.approx(-lost / 4 * math.tau, abs=0.05)


def test_an_open_motor_coasts_and_a_shorted_one_brakes():
    speeds = {}
    for released in ("open", "short"):
        made = fed(motor("SM-42BYG011-25").parameters(), HBridge(supply=12.0, released=released))
        twin = StepperTwin(made, ShaftLoad(inertia=2e-5))
        twin.queue(ramp(150, 300.0, 1500.0, 0.05))
        twin.run(0.5)
        twin.set_enabled(False)
        run = twin.run(0.05)
        speeds[released] = abs(run.omega[-1])
        if released == "open":
            assert np.abs(run.currents[-1]).max() < 1e-3
    assert speeds["open"] > 5
    assert speeds["short"] < 1


def test_hold_current_is_reduced_after_its_delay_and_comes_back_with_the_next_step():
    made = fed(BIG, Chopper(supply=24.0, current=2.0, decay="slow", hold_current=0.5, hold_delay=0.05), 1)
    twin = StepperTwin(made, levels=MEAN)
    twin.queue(np.array([0.01]))
    before = np.abs(twin.run(0.055).currents[-1])
    after = np.abs(twin.run(0.1).currents[-1])
    assert before == pytest.approx([2.0, 2.0], rel=0.06)
    assert after == pytest.approx([1.0, 1.0], rel=0.02)
    twin.queue(np.array([twin.now + 0.001]))
    assert np.abs(twin.run(0.02).currents[-1]) == pytest.approx([2.0, 2.0], rel=0.06)


@pytest.mark.parametrize(("steps", "jump"), [(1.9, 0), (-1.9, 0), (2.1, -4), (-3.0, 4)])
def test_power_up_pulls_the_rotor_to_the_nearest_stable_point(steps: float, jump: int):
    made = fed(replace(BIG, friction=0.01), Chopper(supply=24.0, current=2.0), 1)
    twin = StepperTwin(made, ShaftLoad(viscous=5e-3), angle=steps * math.pi / 2)
    run = twin.run(0.4)
    at_rest = made.motor.teeth * run.theta[-1] - made.excitation.first_angle
    assert at_rest == pytest.approx(-jump / 4 * math.tau, abs=0.05)
    assert run.lost_steps[-1] == jump


def test_braking_with_nearly_all_torque_is_done_switch_by_switch_though_the_angle_is_small():
    """At speed the currents lag: a load that overruns is held at a small load angle, and the margin sees it."""
    made, speed = fed(BIG, Chopper(supply=24.0, current=2.0), 16), 1500
    free = ShaftLoad(inertia=2e-5, friction=0.03, viscous=2e-3)
    overrun = 0.9 * float(made.gross_pull_out(np.array(BIG.speed(speed)))) + 0.03 + 2e-3 * BIG.speed(speed)
    for margin, switches in ((0.0, False), (0.15, True)):
        twin = StepperTwin(made, free, levels=Levels(margin=margin))
        twin.queue(ramp(40000, 16.0 * speed, 32000.0, 0.05))
        twin.run(0.9)
        for part in np.linspace(0.05, 1.0, 20):
            twin.set_load(replace(free, constant=-part * overrun))
            twin.run(0.02)
        before = twin.switched
        run = twin.run(0.05, every=5)
        assert run.lost_steps[-1] == 0
        assert math.degrees(np.abs(run.load_angle).max()) < 30
        assert (twin.switched > before) == switches


@pytest.mark.parametrize(
    "mode", ["one-phase", "two-phase", "half-step", "microstep-4", "microstep-16", "microstep-table"]
)
@pytest.mark.parametrize("driver", ["bridge", "chopper"])
@pytest.mark.parametrize("direction", [1, -1])
def test_what_is_lost_is_lost_by_four_full_steps_in_every_excitation(driver: str, mode: str, direction: int):
    """Driven too fast to follow, then at rest again: the rotor stands on a stable point, whole teeth off."""
    stepper = replace(BIG, friction=0.005)
    feed = HBridge(supply=5.0, drop=0.0, excitation=mode) if driver == "bridge" else Chopper(
        supply=24.0, current=2.0, excitation=mode
    )  # fmt: skip
    made = fed(stepper, feed)
    twin = StepperTwin(made, ShaftLoad(inertia=2e-5, viscous=4e-3))
    twin.run(0.05)
    turn = made.excitation.steps_per_full_step
    twin.queue(twin.now + np.arange(1, 200 * turn) / (4000.0 * turn), direction)
    run = twin.run(0.6)
    lost = int(run.lost_steps[-1])
    assert lost * direction > 0
    assert lost % 4 == 0
    assert run.load_angle[-1] == pytest.approx(lost / 4 * math.tau, abs=0.1)


def test_a_resonance_costs_steps_and_the_motor_runs_again_above_it():
    """S1-F06 out of the physics: at a rate near sqrt(p T/J)/2 pi steps are lost, faster none; damped none at either."""
    made = fed(BIG, Chopper(supply=24.0, current=2.0, excitation="two-phase"))
    load = ShaftLoad(inertia=2e-5, friction=0.005)
    own = math.sqrt(50 * made.holding / (BIG.inertia + load.inertia)) / math.tau
    for viscous, loses in ((0.0, True), (0.02, False)):
        twin = StepperTwin(made, replace(load, viscous=viscous), levels=MEAN)
        twin.queue(0.05 + np.arange(1, int(own)) / own)  # for a second
        at = twin.run(1.05, every=20).lost_steps
        assert bool(at.any()) == loses
        pace = twin.now + np.arange(1, int(own)) / (2 * own)
        twin.queue(pace)
        begin, settled = twin.run(0.2, every=20), twin.run(0.25, every=20)
        assert np.ptp(settled.lost_steps) == 0
        assert np.ptp(settled.theta) == pytest.approx(BIG.speed(2 * own) * 0.25, rel=0.05)
        assert begin.time.size


def test_mid_band_instability_is_there_behind_a_chopper_and_goes_with_damping():
    """Above the corner the chopper is a voltage drive, where linear theory has the growth; below it is a current."""
    made = fed(BIG, Chopper(supply=12.0, current=2.0, decay="slow"), 16)
    assert made.corner == pytest.approx(BIG.speed(1014), rel=1e-3)
    for speed, viscous, levels, steady in (
        (800, 0.0, SWITCHED, True), (1400, 0.0, SWITCHED, False), (1400, 0.0, MEAN, False),
        (1400, 8e-3, SWITCHED, True),
    ):  # fmt: skip
        load = ShaftLoad(viscous=viscous)
        if speed > 1014:
            assert (growth_rate(made.motor, BIG.speed(speed), 12.0, load) < 0) == steady
        twin = StepperTwin(made, load, levels=levels)
        rate = 16.0 * speed
        twin.queue(ramp(int(0.6 * rate), rate, rate / 0.2, 0.05))
        late = twin.run(0.65, every=50).omega[-100:]
        ripple = float(late.std()) / BIG.speed(speed)
        assert (ripple < 0.04) == steady
        assert steady or ripple > 0.1
