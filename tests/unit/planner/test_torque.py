"""The torque profile against the integral of dv / A(v), and against the trapezoid where acceleration does not fall."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from trochia.languages import gcode
from trochia.machine.acceleration import AccelerationCurve
from trochia.machine.axes import PathLimits
from trochia.machine.load import load, loads
from trochia.machine.torque import drive
from trochia.planner import plan
from trochia.toolpath import build

MILL = load("reference-mill")
STRAIGHT = AccelerationCurve(knots=((0.0, 2000.0), (200.0, 100.0)))
BENT = AccelerationCurve(knots=((10.0, 3000.0), (60.0, 1200.0), (150.0, 900.0), (200.0, 60.0)))
MIXED = "G64 P0.05\nF9000\nG1 X30\nG3 X40 Y10 J10\nG1 Y30\nX0 Y31 Z5\nG2 X0 Y0 I5 J-15.5\nG0 X60 Y60"

AXIS = """
[axes.{0}]
minimum = "0 mm"
maximum = "100 mm"
velocity = "300 mm/s"
acceleration = "100 m/s²"

[joints.{0}]
motor = {{ kind = "stepper", full_steps = 200, microsteps = 8, library = "QSH5718-55" }}
driver = {{ kind = "chopper", supply = "24 V", current = "2 A" }}
transmission = {{ kind = "leadscrew", lead = "10 mm" }}
load = {{ mass = "4 kg", friction = "10 N" }}
"""


def machine(**curves):
    axes = tuple(dataclasses.replace(axis, acceleration=4000.0, acceleration_curve=curves.get(axis.name))
                 for axis in MILL.axes)  # fmt: skip
    return dataclasses.replace(MILL, axes=axes)


def planned(text, on, profile="torque"):
    program = gcode.read(text + "\nM2\n")
    return plan(build(program, on), on, program=program, profile=profile)


def way(curve, speed):
    """Way from rest to a speed: the integral of v dv / A(v) [mm]."""
    corners = [v for v, _ in curve.knots if 0.0 < v < speed]
    return quad(lambda v: v / float(curve.at(v)), 0.0, speed, points=corners or None)[0]


def exact(curve, length, top):
    """Time of one move from rest to rest, as fast as the curve allows [s]."""
    if 2 * way(curve, top) > length:
        top = brentq(lambda v: 2 * way(curve, v) - length, 1e-6, top)
        return 2 * curve.time(top)
    return 2 * curve.time(top) + (length - 2 * way(curve, top)) / top


@pytest.mark.parametrize("curve", [STRAIGHT, BENT])
@pytest.mark.parametrize("length", [0.01, 1.0, 20.0, 100.0, 250.0])
def test_a_single_move_takes_the_integral_of_the_curve(curve, length):
    duration = planned(f"G0 X{length}", machine(X=curve)).duration
    expected = exact(curve, length, 200.0)
    assert duration >= expected * (1 - 1e-9)
    assert duration <= expected * 1.002


def test_a_diagonal_keeps_both_curves_at_their_own_speeds():
    # Y goes at half of X's speed: along the line X alone binds, or Y where its own curve is worse than half
    on = machine(X=STRAIGHT, Y=STRAIGHT)
    assert planned("G0 X100 Y50", on).duration == pytest.approx(planned("G0 X100", on).duration, rel=1e-9)


def test_without_curves_it_is_the_trapezoid():
    torque, trapezoid = (planned(MIXED, MILL, name).duration for name in ("torque", "trapezoid"))
    assert torque >= trapezoid * (1 - 1e-9)  # bends are held by the greatest of each piece
    assert torque <= trapezoid * 1.02
    line = "G1 X100 F3000\nG4 P0.2\nG1 X0"
    assert planned(line, MILL).duration == pytest.approx(planned(line, MILL, "trapezoid").duration, rel=1e-9)


def test_it_is_faster_than_the_least_of_the_curve():
    on = machine(X=BENT, Y=BENT)
    assert planned(MIXED, on).duration < 0.8 * planned(MIXED, on, "trapezoid").duration


def test_caps_on_the_vector_bind_too():
    on = dataclasses.replace(machine(X=BENT, Y=BENT), path=PathLimits(velocity=80.0, acceleration=700.0))
    trajectory = planned(MIXED, on)
    t = np.linspace(0, trajectory.duration, 20_001)
    assert np.linalg.norm(trajectory.velocity(t)[:, :3], axis=1).max() <= 80.0 * (1 + 1e-9)
    assert np.linalg.norm(trajectory.acceleration(t)[:, :3], axis=1).max() <= 700.0 * (1 + 1e-9)


def test_speed_ends_with_the_curve():
    on = machine(X=AccelerationCurve(knots=((0.0, 2000.0), (90.0, 1500.0))))
    assert planned("G0 X100", on).peaks["X"]["velocity"] == pytest.approx(90.0)


def test_motors_that_the_file_names_keep_the_margin_of_their_torque():
    axes = "".join(AXIS.format(name) for name in "XY")
    on = loads('format = 1\nname = "table"\nkinematics = "cartesian"\n' + axes)
    trajectory = planned("G0 X40 Y25\nG1 X10 F6000\nG0 X0 Y0", on)
    t = np.linspace(0, trajectory.duration, 4001)
    uses = []
    for index, row in enumerate(on.kinematics.matrix):
        motor = drive(on, index)
        assert motor is not None
        velocity, acceleration = trajectory.velocity(t) @ row, trajectory.acceleration(t) @ row
        free = np.abs(acceleration) > 0.0
        assert (np.abs(acceleration[free]) <= motor.acceleration(velocity[free]) * (1 + 1e-6)).all()
        uses.append(np.max(np.abs(acceleration[free]) / motor.acceleration(velocity[free])))
    assert max(uses) > 0.95
