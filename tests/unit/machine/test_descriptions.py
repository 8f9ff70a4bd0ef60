"""Descriptions made in Python are held to the same bounds as files."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.machine.axes import Axis, AxisKind, PathLimits
from trochia.machine.io import Beam, Channel, Spindle
from trochia.machine.joints import Encoder, Joint, PulseTiming, Servo, Stepper
from trochia.machine.kinematics import Cartesian, CoreXY, Lathe
from trochia.machine.machine import Machine
from trochia.machine.rates import braking_distance, joint_velocity, resolution, step_rate
from trochia.machine.transmissions import Belt, Direct, Leadscrew, Rack, Travel


def axis(name: str = "X", **changes: object) -> Axis:
    kind = AxisKind.ROTARY if name in "ABC" else AxisKind.LINEAR
    values = {"kind": kind, "minimum": 0.0, "maximum": 100.0, "velocity": 50.0, "acceleration": 500.0} | changes
    return Axis(name=name, **values)


def joint(name: str = "X", **changes: object) -> Joint:
    values = {"motor": Stepper(), "transmission": Leadscrew(lead=Fraction(2))} | changes
    return Joint(name=name, **values)


def machine(axes: str = "XY", **changes: object) -> Machine:
    values = {
        "name": "m",
        "axes": tuple(axis(letter) for letter in axes),
        "joints": tuple(joint(letter) for letter in axes),
        "kinematics": Cartesian(tuple(range(len(axes))), len(axes)),
    } | changes
    return Machine(**values)


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: axis(velocity=float("nan")), "axes.X.velocity"),
        (lambda: axis(maximum=float("inf")), "axes.X.maximum"),
        (lambda: axis(jerk=-1.0), "axes.X.jerk"),
        (lambda: axis(maximum=0.0), "axes.X.maximum"),
        (lambda: axis("T"), "axes.T"),
        (lambda: joint(backlash=-0.1), "joints.X.backlash"),
        (lambda: joint(pulse_rate=0.0), "joints.X.pulse_rate"),
        (lambda: PulseTiming(length=0.0), "length"),
        (lambda: Encoder(counts=Fraction(0)), "counts"),
        (lambda: Stepper(microsteps=0), "microsteps"),
        (lambda: Belt(pitch=Fraction(2), teeth=-20), "teeth"),
        (lambda: Spindle(maximum=0.0), "spindle.maximum"),
        (lambda: Spindle(maximum=5.0, encoder=Encoder(counts=Fraction(4), on_load=True)), "spindle.encoder.on_load"),
        (lambda: Beam(kind="candle"), "beam.kind"),
        (lambda: Beam(kind="power", full_power=0.0), "beam.full_power"),
        (lambda: Channel(name="out", kind="latched", load=1.0), "io.out.load"),
        (lambda: machine(servo_period=0.0), "servo_period"),
        (lambda: machine(path_tolerance=-1.0), "path_tolerance"),
        (lambda: machine(axes="", joints=()), "axes"),
        (lambda: machine(joints=()), "joints"),
        (lambda: machine("YX"), "axes"),
        (lambda: machine("XX"), "axes"),
        (lambda: machine(joints=(joint("X"), joint("X"))), "joints"),
        (lambda: machine(joints=(joint("X"),)), "joints"),
        (lambda: machine(kinematics=Cartesian((0, 0), 2)), "axes.Y"),
        (lambda: machine("XA"), "joints.A.transmission.kind"),
        (lambda: machine(joints=(joint("X", motor=Servo(), pulse_rate=5.0), joint("Y"))), "joints.X.pulse_rate"),
    ],
)
def test_what_cannot_be_is_refused_at_construction(make, key: str):
    with pytest.raises(ConfigError) as caught:
        make()
    assert caught.value.key == key


@pytest.mark.parametrize(
    ("transmission", "travel"),
    [
        (Leadscrew(lead=Fraction("5.08"), ratio=Fraction(2)), Fraction("2.54")),
        (Belt(pitch=Fraction(2), teeth=20), 40),
        (Rack(pitch=Fraction("3.14"), teeth=10, ratio=Fraction(-5)), Fraction("-6.28")),
        (Direct(ratio=Fraction(72)), 5),
        (Travel(per_turn=Fraction(8), ratio=Fraction(1, 3)), 24),
    ],
)
def test_travel_of_one_turn_is_exact(transmission, travel: Fraction):
    assert transmission.travel_per_turn == travel


def test_scales_are_exact():
    one = joint(motor=Stepper(microsteps=16), transmission=Leadscrew(lead=Fraction("3.175"), ratio=Fraction(26)),
                encoder=Encoder(counts=Fraction(30)))  # fmt: skip
    assert one.steps_per_unit == Fraction(3200 * 26 * 40, 127)
    assert one.counts_per_unit == Fraction(780 * 40, 127)
    assert joint(encoder=Encoder(counts=Fraction(7, 3), on_load=True)).counts_per_unit == Fraction(7, 3)
    assert joint(motor=Servo()).steps_per_unit is None
    assert joint().counts_per_unit is None


def test_kinematics_as_matrices():
    np.testing.assert_array_equal(Cartesian((0, 1, 1), 2).matrix, [[1, 0], [0, 1], [0, 1]])
    np.testing.assert_array_equal(CoreXY(3).matrix, [[1, 1, 0], [1, -1, 0], [0, 0, 1]])
    np.testing.assert_array_equal(CoreXY(3, (2, 2)).matrix, [[1, 1, 0], [1, -1, 0], [0, 0, 1], [0, 0, 1]])


@pytest.mark.parametrize(
    ("cls", "axes", "joints", "key"),
    [
        (CoreXY, ("X", "Z"), {"a": None, "b": None}, "axes"),
        (CoreXY, ("X", "Y"), {"a": None}, "joints"),
        (CoreXY, ("X", "Y"), {"a": "X", "b": None}, "joints.a.axis"),
        (CoreXY, ("X", "Y", "Z"), {"a": None, "b": None, "pen": None}, "joints.pen.axis"),
        (Lathe, ("X", "Y"), {"X": None, "Y": None}, "axes"),
        (Cartesian, ("X", "Y"), {"X": None, "left": "W"}, "joints.left.axis"),
    ],
)
def test_joints_that_do_not_fit_their_kinematics(cls, axes, joints, key: str):
    with pytest.raises(ConfigError) as caught:
        cls.fit(axes, joints)
    assert caught.value.key == key


def test_rates_of_crossed_belts():
    belts = machine(joints=(joint("a"), joint("b")), kinematics=CoreXY(2))
    assert joint_velocity(belts, 0) == 100.0  # both axes at 50 mm/s
    assert step_rate(belts, 1) == 100.0 * 100  # 200 steps over 2 mm
    assert resolution(belts, 0) == 0.01


def test_path_cap_and_joint_limit_bound_a_joints_speed():
    capped = machine(joints=(joint("a"), joint("b")), kinematics=CoreXY(2), path=PathLimits(velocity=50.0))
    assert joint_velocity(capped, 0) == pytest.approx(50 * 2**0.5)  # along the diagonal
    limited = machine(joints=(joint("X", velocity=20.0), joint("Y")))
    assert [joint_velocity(limited, n) for n in (0, 1)] == [20.0, 50.0]


@pytest.mark.parametrize(
    ("velocity", "acceleration", "jerk", "distance"),
    [
        (200.0, 800.0, None, 25.0),
        (200.0, 800.0, 20000.0, 100 * (0.25 + 0.04)),
        (10.0, 1000.0, 100.0, 10 * 0.1**0.5),  # acceleration is never reached
        (10.0, 100.0, 1000.0, 1.0),  # just reached: both forms agree
    ],
)
def test_braking_distance(velocity: float, acceleration: float, jerk: float | None, distance: float):
    one = axis(velocity=velocity, acceleration=acceleration, jerk=jerk)
    assert braking_distance(one) == pytest.approx(distance)


def test_braking_distance_is_the_integral_of_the_jerk_limited_stop():
    v, a, j = 200.0, 800.0, 20000.0
    ramp, hold = a / j, v / a - a / j
    t = np.linspace(0, 2 * ramp + hold, 200_001)
    down = np.interp(t, [0, ramp, ramp + hold, 2 * ramp + hold], [0, -a, -a, 0])
    dt = t[1]
    speed = v + np.concatenate([[0], np.cumsum((down[1:] + down[:-1]) / 2 * dt)])
    assert speed[-1] == pytest.approx(0, abs=1e-6)
    way = np.sum((speed[1:] + speed[:-1]) / 2 * dt)
    assert braking_distance(axis(velocity=v, acceleration=a, jerk=j)) == pytest.approx(way, rel=1e-6)
