"""What a joint's motor gives in its own units, against hand-made mechanics."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.machine.dump import dumps
from trochia.machine.load import loads
from trochia.machine.torque import acceleration_curve, drive

STAGE = """
format = 1
name = "stage"
kinematics = "cartesian"
[axes.X]
minimum = "0 mm"
maximum = "200 mm"
velocity = "100 mm/s"
acceleration = "1000 mm/s²"
[joints.X]
motor = { kind = "stepper", library = "QSH5718-55", microsteps = 16 }
driver = { kind = "chopper", supply = "24 V", current = "2 A" }
load = { mass = "3 kg", inertia = "100 g·cm²", friction = "5 N", force = "20 N", margin = 0.25 }
transmission = { kind = "leadscrew", lead = "5 mm" }
"""
ARM = 5e-3 / math.tau  # m a radian


def test_masses_and_forces_come_through_the_screw():
    motor = drive(loads(STAGE), 0)
    assert motor is not None
    assert motor.load.inertia == pytest.approx(1e-5 + 3 * ARM**2)
    assert motor.load.friction == pytest.approx(5 * ARM)
    assert motor.load.constant == pytest.approx(20 * ARM)
    assert motor.inertia == pytest.approx(209e-7 + 1e-5 + 3 * ARM**2)


def test_torque_needed_is_newton_s_law_up_and_down():
    motor = drive(loads(STAGE), 0)
    assert motor is not None
    up, down = motor.needed(np.array([50.0, -50.0]), np.array([1000.0, 1000.0]))
    inertial = motor.inertia * 1.0 / ARM
    assert up == pytest.approx(inertial + 20 * ARM)
    assert down == pytest.approx(-(inertial + 20 * ARM))  # braking on the way down: against the motion
    assert motor.braking(np.array(-50.0)) > motor.available(np.array(-50.0))


def test_a_mirrored_screw_needs_the_same():
    plain, mirrored = loads(STAGE), loads(STAGE.replace('lead = "5 mm"', 'lead = "5 mm", ratio = -1'))
    v, a = np.array([60.0, -60.0, 10.0]), np.array([800.0, 800.0, -300.0])
    one, other = drive(plain, 0), drive(mirrored, 0)
    assert one is not None
    assert other is not None
    assert other.used(v, a) == pytest.approx(one.used(v, a))


def test_planned_acceleration_leaves_the_margin():
    motor = drive(loads(STAGE), 0)
    assert motor is not None
    speeds, accelerations = acceleration_curve(motor, 100.0)
    assert motor.used(speeds[1:], accelerations[1:]).max() < 1 - 0.25 + 0.25 * 20 * ARM / 0.3
    spare = (1 - motor.margin) * motor.available(speeds) - 20 * ARM
    assert accelerations == pytest.approx(spare / motor.inertia * ARM * 1e3)


def test_an_unreachable_speed_names_the_one_that_is():
    motor = drive(loads(STAGE.replace('force = "20 N"', 'force = "200 N"')), 0)
    assert motor is not None
    top = motor.greatest_velocity
    assert 0.0 < top < 1000.0
    with pytest.raises(ConfigError, match="beyond what the motor reaches") as caught:
        acceleration_curve(motor, 1.1 * top)
    assert f"At most {0.95 * top:.4g} would do" in str(caught.value)


def test_the_file_reads_back_and_refuses_what_does_not_fit():
    machine = loads(STAGE)
    assert loads(dumps(machine)) == machine
    for old, new, said in (
        ('library = "QSH5718-55", ', "", "says what it is"),
        ("QSH5718-55", "QSH5718-56", "did you mean QSH5718-55"),
        ("microsteps = 16", "microsteps = 16, full_steps = 400", "must be 200"),
        ("margin = 0.25", "margin = 1", "below 1"),
        ('current = "2 A"', 'current = "50 A"', "A supply above"),
        ("force =", "efficiency = 1.5, force =", "at most 1"),
    ):
        with pytest.raises(ConfigError) as caught:
            loads(STAGE.replace(old, new))
        assert said in str(caught.value)
        assert "joints.X" in str(caught.value)
