"""Axes that swing and axes whose acceleration falls with speed, in the machine file and as closed forms."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from trochia.errors import ConfigError, MachineError
from trochia.machine.acceleration import AccelerationCurve
from trochia.machine.dump import dumps
from trochia.machine.load import load, loads
from trochia.machine.resonance import Resonance
from trochia.planner import Limits

MILL = load("reference-mill")
CURVE = AccelerationCurve(knots=((0.0, 2000.0), (50.0, 1500.0), (150.0, 100.0)))


def with_x(**values):
    return dataclasses.replace(MILL, axes=(dataclasses.replace(MILL.axes[0], **values), *MILL.axes[1:]))


def text_with(line):
    return dumps(MILL).replace("[axes.X]\n", f"[axes.X]\n{line}\n", 1)


@pytest.mark.parametrize("comments", [False, True])
def test_both_are_written_and_read_back(comments):
    machine = with_x(resonance=Resonance(frequency=42.5, damping=0.07, shaper="ei"), acceleration_curve=CURVE)
    assert loads(dumps(machine, comments=comments)) == machine


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("resonance = { damping = 0.1 }", "frequency"),
        ('resonance = { frequency = "45 Hz", shaper = "zw" }', "zv"),
        ('resonance = { frequency = "45 Hz", damping = 0.95 }', "at most 0.9"),
        ('acceleration_curve = "2000 mm/s²"', "expected pairs"),
        ('acceleration_curve = [["0 mm/s"]]', "expected pairs"),
        ('acceleration_curve = [["0 mm/s", "2000 mm/s"]]', "acceleration"),
        ('acceleration_curve = [["0 mm/s", "500 mm/s²"], ["9 mm/s", "600 mm/s²"]]', "must not rise"),
        ('acceleration_curve = [["9 mm/s", "500 mm/s²"], ["9 mm/s", "400 mm/s²"]]', "speeds must rise"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_with_its_key(line, told):
    with pytest.raises(MachineError, match=told) as caught:
        loads(text_with(line))
    assert "axes.X" in str(caught.value)


def test_profiles_without_curves_keep_the_least_of_one():
    limits = Limits.of(with_x(acceleration_curve=CURVE, acceleration=1800.0))  # 200 mm/s, beyond the last knot
    assert (limits.velocity[0], limits.acceleration[0]) == (150.0, 100.0)
    assert limits.curves[0].at([0.0, 20.0, 50.0, 100.0]) == pytest.approx([1800.0, 1800.0, 1500.0, 800.0])
    assert Limits.of(with_x(acceleration_curve=CURVE, velocity=50.0)).acceleration[0] == pytest.approx(800.0)


def test_a_motor_over_what_it_moves():
    # T = TL + J dv/dt, 0.4 falling to 0.1, load 0.15: nothing is left beyond three quarters of the way
    curve = AccelerationCurve.of_torque([0.0, 50.0, 100.0, 120.0], [0.4, 0.3, 0.2, 0.1], 0.15, 1e-4)
    assert np.array(curve.knots) == pytest.approx(np.array([[0.0, 2500.0], [50.0, 1500.0], [100.0, 500.0]]))
    with pytest.raises(ConfigError, match="does not exceed the load"):
        AccelerationCurve.of_torque([0.0, 1.0], [0.1, 0.1], 0.2, 1.0)


def test_time_to_a_speed_is_the_integral_of_its_inverse():
    for speed in (10.0, 50.0, 149.0):
        expected, _ = quad(lambda v: 1.0 / float(CURVE.at(v)), 0.0, speed, points=[50.0])
        assert CURVE.time(speed) == pytest.approx(expected, rel=1e-9)
    # a straight line from A to B by V: ln(A / B) V / (A - B)
    straight = AccelerationCurve(knots=((0.0, 1000.0), (100.0, 10.0)))
    assert straight.time(100.0) == pytest.approx(math.log(100.0) * 100.0 / 990.0)
    assert AccelerationCurve(knots=((100.0, 500.0),)).time(100.0) == pytest.approx(0.2)


@st.composite
def curves(draw):
    count = draw(st.integers(1, 6))
    speeds = np.cumsum(draw(st.lists(st.floats(0.5, 80.0), min_size=count, max_size=count)))
    values = sorted(draw(st.lists(st.floats(1.0, 3000.0), min_size=count, max_size=count)), reverse=True)
    return AccelerationCurve(knots=tuple(zip(speeds.tolist(), values, strict=True)))


@given(one=curves(), other=curves())
def test_the_lesser_of_two_is_nowhere_above_either(one, other):
    least = one.least(other)
    assert least.top == min(one.top, other.top)
    at = np.linspace(0.0, least.top, 501)
    expected = np.minimum(one.at(at), other.at(at))
    assert least.at(at) == pytest.approx(expected, rel=1e-9)


def test_a_curve_below_a_function_is_nowhere_above_it():
    def pull_out(speed):
        return 2000.0 / (1.0 + (speed / 30.0) ** 2)  # convex at speed: straight lines between its values lie above it

    curve = AccelerationCurve.below(pull_out, 200.0)
    at = np.linspace(0.0, 200.0, 3001)
    assert (curve.at(at) <= pull_out(at) * (1 + 2e-4)).all()  # it is looked at in sixteen places a knot
    assert (curve.at(at) >= pull_out(at) * 0.9).all()
    assert curve.top == 200.0
