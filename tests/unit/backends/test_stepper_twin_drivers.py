"""A stepper behind its driver: two levels that agree, release, hold current, power-up, lost steps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.backends.stepper_twin import MEAN, SWITCHED, StepperTwin
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
@pytest.mark.parametrize("name", ["two-phase", "microstep-16"])
def test_the_two_levels_agree(decay: str, name: str):
    micro = 16 if name == "microstep-16" else 1
    made = fed(BIG, Chopper(supply=24.0, current=2.0, decay=decay, excitation=name), micro)
    angles = []
    for levels in (MEAN, SWITCHED):
        twin = StepperTwin(made, LOAD, levels=levels)
        twin.run(0.05)
        twin.queue(ramp(160 * micro, 300.0 * micro, 2000.0 * micro, twin.now))
        run = twin.run(0.7, every=5)
        assert run.lost_steps[-1] == 0
        angles.append(run.load_angle)
    apart = np.degrees(np.sqrt(np.mean((angles[0] - angles[1]) ** 2)))
    assert apart < (6 if name == "two-phase" else 2)


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
