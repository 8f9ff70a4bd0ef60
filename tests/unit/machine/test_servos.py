"""Servo joints in a machine file: what the numbers become at the shaft, closed forms, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.errors import MachineError
from trochia.machine.load import load, loads
from trochia.machine.motors.pmsm import Pmsm
from trochia.machine.servo_plant import Mode
from trochia.machine.servos.drive import servo_drive
from trochia.units import parse

SERVO = """\
format = 1
name = "bench"
kinematics = "cartesian"
[axes.X]
minimum = "0 mm"
maximum = "100 mm"
velocity = "50 mm/s"
acceleration = "500 mm/s²"
[joints.X]
transmission = { kind = "leadscrew", lead = "5 mm", ratio = -2 }
encoder = { counts = 4000 }
backlash = "0.02 mm"
load = { mass = "30 kg", inertia = "0.2 kg·cm²", friction = "40 N", force = "100 N" }
amplifier = { mode = "voltage", command = "10 V", voltage = "48 V", drop = "1 V", pwm = "20 kHz", dead_time = "1 us" }
[joints.X.train]
viscous = "1e-4 N·m·s/rad"
[joints.X.motor]
kind = "servo"
[joints.X.motor.catalogue]
kind = "dc"
resistance = "0.8 ohm"
inductance = "1 mH"
inertia = "0.5 kg·cm²"
torque_constant = "80 mN·m/A"
emf_constant = "8.37758040957 V/krpm"
peak_current = "30 A"
[joints.X.loop]
kind = "cascade"
position_gain = "50 1/s"
speed_gain = "0.02 V·s/rad"
"""


def drive(text: str = SERVO):
    found = servo_drive(loads(text), 0)
    assert found is not None
    return found


def test_a_joint_is_seen_from_its_shaft_in_si():
    """A turn is 2.5 mm, so a radian 2.5/2π mm; masses come with its square, forces with itself."""
    found = drive()
    arm = 2.5e-3 / math.tau
    assert found.per_radian == pytest.approx(1000 * arm, rel=1e-15)
    assert found.plant.motor_inertia == pytest.approx(0.7e-4 + 30 * arm**2, rel=1e-12)
    assert found.plant.motor_friction.coulomb == pytest.approx(40 * arm, rel=1e-12)
    assert found.plant.load == pytest.approx(100 * arm, rel=1e-12)
    assert found.plant.counts == pytest.approx(4000 / math.tau, rel=1e-12)
    assert found.plant.emf_constant == pytest.approx(0.08, rel=1e-9)  # V/krpm is 60/2000π V·s/rad
    assert found.play == 0.02


def test_dead_time_works_against_the_current_as_a_drop_does():
    assert drive().plant.amplifier.drop == pytest.approx(1 + 48 * 20e3 * 1e-6)


def test_with_a_spring_the_load_is_a_second_body_and_backlash_its_gap():
    text = SERVO.replace("[joints.X.train]", '[joints.X.train]\nstiffness = "500 N·m/rad"')
    plant = drive(text).plant
    arm = 2.5e-3 / math.tau
    assert plant.load_inertia == pytest.approx(30 * arm**2)
    assert plant.motor_inertia == pytest.approx(0.7e-4)
    assert plant.gap == pytest.approx(0.02e-3 / arm)
    assert drive(text).play == 0


def test_torque_there_is_the_lesser_of_current_and_supply():
    found = drive()
    speeds = np.array([0.0, 20.0, 45.0])
    spare = (48 - 1.96 - 0.08 * speeds / found.per_radian) / 0.8
    np.testing.assert_allclose(found.available(speeds), 0.08 * np.minimum(30, spare))
    # at a steady speed: friction, viscous part and the constant force
    arm = 2.5e-3 / math.tau
    needed = 140 * arm + 1e-4 * 20e-3 / arm
    assert float(found.needed(np.array(20.0), np.array(0.0))) == pytest.approx(needed)


def test_greatest_velocity_is_where_torque_there_meets_torque_needed():
    found = drive()
    v = np.array(found.greatest_velocity)
    assert float(found.available(v)) == pytest.approx(float(found.needed(v, np.array(0.0))), rel=1e-9)


def test_the_lathe_gives_the_gain_and_the_pole_that_were_identified():
    """2.0866 pulses/s a step of the PWM and 74.29 rad/s; the winding's own pole is far off."""
    found = servo_drive(load("lathe"), 1)
    assert found is not None
    gain = found.catalogue.parameters().gain() * 22 / 1023 * 30 / math.tau
    assert gain == pytest.approx(2.0866, rel=0.01)
    slow, fast = found.catalogue.parameters().poles()
    assert -slow == pytest.approx(74.29, rel=0.03)
    assert -fast > 2000
    assert found.catalogue.parameters().stall_torque(22) / 0.0393 == pytest.approx(4)


def test_the_xy_tables_card_scales():
    """Table of the card: 4096 counts a mm, fatal following error 2000 counts, warning 1000."""
    table = load("xy-table")
    for joint in table.joints:
        assert joint.counts_per_unit is not None
        assert float(joint.counts_per_unit) * (joint.following_error or 0) == 2000
        assert float(joint.counts_per_unit) * (joint.following_warning or 0) == 1000


@pytest.mark.parametrize(
    ("old", "new", "key", "says"),
    [
        ('mode = "voltage", ', "", "joints.X.amplifier.current", "missing"),
        ('pwm = "20 kHz", ', "", "joints.X.amplifier.dead_time", "needs pwm"),
        ('"80 mN·m/A"', '"80 mN·m"', "joints.X.motor.catalogue.torque_constant", "torque constant"),
        ('drop = "1 V"', 'drop = "50 V"', "joints.X.amplifier.drop", "48 V"),
        ('kind = "cascade"', 'kind = "casade"', "joints.X.loop.kind", "cascade"),
        ("[joints.X.train]", '[joints.X.train]\nstick = "1 N·m"', "joints.X.train.stick", "together"),
        ("encoder = { counts = 4000 }", "encoder = { counts = 4000, on_load = true }", "joints.X.train.stiffness",
         "closes on"),
        ('mass = "30 kg", ', "", "", ""),
    ],
)  # fmt: skip
def test_what_cannot_be_is_named(old, new, key, says):
    text = SERVO.replace(old, new)
    assert text != SERVO
    if not key:
        text = text.replace("[joints.X.train]", '[joints.X.train]\nstiffness = "500 N·m/rad"')
        key, says = "joints.X.train.stiffness", "load.mass"
    with pytest.raises(MachineError, match=says) as caught:
        loads(text)
    assert key in str(caught.value)


@pytest.mark.parametrize("part", ["amplifier", "motor.catalogue", "encoder"])
def test_a_loop_needs_what_it_closes(part):
    lines = SERVO.replace('kind = "cascade"', 'kind = "pmac"\ni30 = 1000').splitlines()
    lines = [line for line in lines if not line.startswith(("position_gain", "speed_gain"))]
    if part == "motor.catalogue":
        begin = lines.index("[joints.X.motor.catalogue]")
        lines = lines[:begin] + lines[begin + 8 :]
    else:
        lines = [line for line in lines if not line.startswith(part)]
    with pytest.raises(MachineError, match="needs"):
        loads("\n".join(lines))


def test_a_brushless_motor_with_no_field_current_is_one_of_direct_current():
    """With the field held at zero by voltage: the same derivative, Kt = 3/2 p psi, Kb = p psi."""
    motor = Pmsm(resistance=1.2, inductance_d=4e-3, inductance_q=4e-3, flux=0.04, pole_pairs=5, inertia=2e-5,
                 viscous=1e-4)  # fmt: skip
    dc = motor.as_dc()
    i_q, speed, v_q = 3.0, 150.0, 70.0
    v_d = -motor.pole_pairs * speed * motor.inductance_q * i_q
    rate = motor.derivative(np.array([0.0, i_q, speed]), v_d, v_q, 0.2)
    np.testing.assert_allclose(rate, [0.0, *dc.derivative(np.array([i_q, speed]), v_q, 0.2)], atol=1e-9)
    assert dc.torque_constant == pytest.approx(1.5 * dc.emf_constant)


def test_what_the_supply_lets_a_brushless_motor_draw_uses_it_up():
    motor = Pmsm(resistance=1.2, inductance_d=4e-3, inductance_q=4e-3, flux=0.04, pole_pairs=5, inertia=2e-5)
    for speed in (0.0, 100.0, 400.0):
        most = motor.most_current(speed, 100.0)
        assert motor.voltage(most, speed) == pytest.approx(100.0)
    assert motor.most_current(1e4, 100.0) == -math.inf


def test_power_in_is_power_out_and_heat():
    """3/2 (vd id + vq iq) = torque w + 3/2 R i² at steady currents, with saliency too."""
    motor = Pmsm(resistance=0.5, inductance_d=2e-3, inductance_q=3e-3, flux=0.05, pole_pairs=4, inertia=1e-4)
    i_d, i_q, w = -2.0, 5.0, 120.0
    electric = motor.pole_pairs * w
    v_d = motor.resistance * i_d - electric * motor.inductance_q * i_q
    v_q = motor.resistance * i_q + electric * (motor.inductance_d * i_d + motor.flux)
    np.testing.assert_allclose(motor.derivative(np.array([i_d, i_q, w]), v_d, v_q)[:2], 0, atol=1e-9)
    heat = 1.5 * motor.resistance * (i_d**2 + i_q**2)
    assert 1.5 * (v_d * i_d + v_q * i_q) == pytest.approx(float(motor.torque(np.array(i_d), np.array(i_q))) * w + heat)


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [("41.9 mN·m/A", "torque constant", 0.0419), ("10.47197551 V/krpm", "emf constant", 0.1),
     ("50 1/s", "rate", 50), ("200 N·m/rad", "stiffness", 200), ("1 mN·m/krpm", "viscous friction", 9.5493e-6)],
)  # fmt: skip
def test_units_of_servos(text, dimension, value):
    assert parse(text, dimension) == pytest.approx(value, rel=1e-4)


def test_modes_are_those_of_the_equations():
    assert drive().plant.amplifier.mode is Mode.VOLTAGE
    assert drive(SERVO.replace('mode = "voltage"', 'mode = "current", current = "9 A"')).plant.amplifier.gain == 0.9
