"""Errors of joints by place, what corrects them, and what that takes of the limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import trochia
from trochia.errors import ConfigError
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.crossing import crossing_of, leaning
from trochia.machine.dump import dumps
from trochia.machine.error_table import ErrorTable
from trochia.machine.joints import PulseTiming
from trochia.machine.load import inspect_text, loads
from trochia.machine.reserve import shares
from trochia.planner.limits import Limits

POINTS = ((-10.0, 0.0), (40.0, 0.012), (90.0, -0.004), (150.0, 0.02), (230.0, 0.015), (410.0, 0.03))


@pytest.fixture
def laser():
    return trochia.load("laser")


def quick(machine, velocity):
    """Return a machine of faster axes."""
    axes = tuple(replace(axis, velocity=velocity, acceleration=1000.0) for axis in machine.axes)
    pulses = PulseTiming(length=4e-7, space=4e-7)
    joints = tuple(replace(joint, velocity=None, pulse_rate=None, pulses=pulses) for joint in machine.joints)
    return replace(machine, axes=axes, joints=joints)


def corrected(machine, **given):
    return replace(machine, joints=(replace(machine.joints[0], compensation=Compensation(**given)),
                                    *machine.joints[1:]))  # fmt: skip


def test_a_table_goes_through_its_points_and_has_no_corners():
    table = ErrorTable(points=POINTS)
    x, e = np.array(POINTS).T
    assert table.at(x) == pytest.approx(e, abs=1e-15)
    far = np.linspace(-100.0, 500.0, 60_001)
    error, slope = table.at(far), table.slope(far)
    h = far[1] - far[0]
    assert np.gradient(error, h)[1:-1] == pytest.approx(slope[1:-1], abs=1e-6)
    s1, s2, s3 = table.steepest
    assert s1 == pytest.approx(np.abs(slope).max(), rel=1e-4)
    bend = np.diff(slope) / h
    assert s2 == pytest.approx(np.abs(bend).max(), rel=1e-3)
    assert np.abs(np.diff(bend)).max() / h == pytest.approx(s3, rel=1e-3)  # no jump of curvature either
    assert table.slope(np.array([-50.0, 450.0])) == pytest.approx(table.slope(np.array([-10.0, 410.0])))


def test_two_points_are_a_line():
    table = ErrorTable(points=((0.0, 0.0), (100.0, 0.05)))
    assert table.at([50.0, 200.0]) == pytest.approx([0.025, 0.1])
    assert table.steepest == pytest.approx((5e-4, 0.0, 0.0))


@pytest.mark.parametrize(
    ("points", "why"),
    [
        (((0.0, 0.0),), "2 to 1000"),
        (((0.0, 0.0), (0.0, 0.1)), "must rise"),
        (((10.0, 0.0), (5.0, 0.0)), "5 stands behind 10"),
        (((0.0, 0.0), (10.0, 1.0)), "right unit"),
        (((0.0, 0.0), (10.0, float("nan"))), "numbers"),
    ],
)
def test_a_table_that_cannot_be_is_refused(points, why):
    with pytest.raises(ConfigError) as refused:
        ErrorTable(points=points)
    assert why in f"{refused.value}"


FILE = """
[squareness]
XY = "0.02 deg"
"""


def with_keys(laser, joint="", end=""):
    return dumps(laser).replace("[joints.X]\n", f"[joints.X]\n{joint}\n") + end


def test_a_file_says_it_and_is_written_as_it_is_read(laser):
    text = with_keys(
        laser,
        'compensation = { backlash = "40 um", screw = [["0 mm", "0 mm"], ["200 mm", "12 um"], ["400 mm", "9 um"]] }\n'
        'screw_error = [["0 mm", "0 mm"], ["400 mm", "9 um"]]',
        FILE,
    )
    machine = loads(text)
    given = machine.joints[0].compensation
    assert given.backlash == pytest.approx(0.04)
    assert given.screw.points[1] == (200.0, 0.012)
    assert machine.squareness.XY == 0.02
    assert loads(dumps(machine)) == machine
    assert loads(dumps(machine, comments=True)) == machine


@pytest.mark.parametrize(
    ("joint", "end", "key", "why"),
    [
        ('compensation = { screw = [["0 mm", "0 mm"], ["0 mm", "5 um"]] }', "", "screw", "must rise"),
        ('compensation = { screw = [["0 mm", "0 mm"], ["1 mm", "5 mm"]] }', "", "screw", "more than 0.02"),
        ('compensation = { screw = [["0 mm", "0 mm"], ["90 mm", "5 um"]] }', "", "screw", "must reach over"),
        ('compensation = { screw = [["0 mm", "0 V"], ["90 mm", "5 um"]] }', "", "screw", "V"),
        ('compensation = { backlash = "-1 um" }', "", "backlash", "zero or more"),
        ('compensation = { backlash = "1 um", share = 0.9 }', "", "share", "0.5 at most"),
        ("", '[squareness]\nXY = "3 deg"\n', "squareness.XY", "within 1 degree"),
        ("", '[squareness]\nXZ = "0.1 deg"\n', "squareness.XZ", "no axes X and Z"),
        ('compensation = { screw = [["0 mm", "0 mm"], ["20 mm", "0.3 mm"], ["40 mm", "0 mm"], ["400 mm", "0 mm"]] }',
         "", "compensation", "at least 40 %"),
    ],
)  # fmt: skip
def test_a_mistake_is_told_once_with_its_key(laser, joint, end, key, why):
    fast = quick(laser, 1500.0) if "40 %" in why else laser
    machine, problems = inspect_text(with_keys(fast, joint, end), "m.toml")
    assert machine is None
    assert len(problems) == 1
    assert key in (problems[0].key or "")
    assert why in f"{problems[0]}"


def test_nothing_to_correct_costs_nothing(laser):
    assert crossing_of(laser) is None
    assert crossing_of(corrected(laser)) is None


def test_backlash_costs_its_share_and_a_table_its_slope(laser):
    whole = Limits.of(laser)
    less = Limits.of(corrected(laser, backlash=0.04, share=0.1))
    assert less.velocity[:2] == pytest.approx(whole.velocity[:2] * [0.9, 1.0])
    assert less.acceleration[:2] == pytest.approx(whole.acceleration[:2] * [0.9, 1.0])
    slope = 1e-3
    line = ErrorTable(points=((0.0, 0.0), (400.0, 400 * slope)))
    less = Limits.of(corrected(laser, screw=line))
    assert less.velocity[0] == pytest.approx(whole.velocity[0] / (1 + slope))
    assert less.acceleration[0] == pytest.approx(whole.acceleration[0] / (1 + slope))


def test_a_table_that_bends_takes_no_more_than_a_quarter_of_the_acceleration(laser):
    places = np.linspace(0.0, 400.0, 81)
    table = ErrorTable(points=tuple(zip(places.tolist(), (0.01 * np.sin(places / 4.0)).tolist(), strict=True)))
    fast = quick(laser, 1000.0)
    machine = corrected(fast, screw=table)
    left = shares(machine, crossing_of(machine).mix)[0]
    s1, s2, _ = table.steepest
    speed = left.velocity * 1000.0
    assert s2 * speed**2 <= 250.0 * (1 + 1e-9)
    assert left.acceleration * 1000.0 * (1 + s1) + s2 * speed**2 <= 1000.0 * (1 + 1e-9)


def test_squareness_keeps_room_for_what_other_axes_add(laser):
    machine = replace(laser, squareness=Squareness(XY=0.5))
    left = shares(machine, crossing_of(machine).mix)
    lean = np.tan(np.radians(0.5))
    assert left[0].velocity == pytest.approx(1 / (1 + lean))
    assert left[1].velocity == 1.0
    mixed = crossing_of(machine).motor(np.array([[0.0, 100.0]]))
    assert mixed[0] == pytest.approx([100 * lean, 100.0])
    square = leaning(machine, machine.squareness, correct=False)
    assert square @ mixed[0] == pytest.approx([0.0, 100.0])


def test_what_motors_were_told_goes_back_to_what_was_asked(laser):
    machine = replace(corrected(laser, screw=ErrorTable(points=POINTS), backlash=0.04), squareness=Squareness(XY=0.3))
    crossing = crossing_of(machine)
    asked = np.random.default_rng(3).uniform(-20.0, 420.0, (200, 2))
    assert crossing.asked(crossing.motor(asked)) == pytest.approx(asked, abs=1e-10)
    h = 1e-4
    way = np.array([0.7, -0.3])
    rise = (crossing.motor(asked + h * way) - crossing.motor(asked - h * way)) / (2 * h)
    assert crossing.rate(asked, np.tile(way, (200, 1))) == pytest.approx(rise, abs=1e-7)


def test_a_gantry_and_crossed_belts_are_corrected_too():
    for name in ("reference-mill", "belt-stage"):
        machine = trochia.load(name)
        if {"X", "Y"} <= {axis.name for axis in machine.axes}:
            lean = leaning(machine, Squareness(XY=0.2), correct=True)
            matrix = machine.kinematics.matrix
            back = np.linalg.pinv(matrix) @ lean @ matrix
            assert back[0, 1] == pytest.approx(np.tan(np.radians(0.2)))
