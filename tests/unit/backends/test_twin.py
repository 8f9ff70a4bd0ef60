"""The twin against closed forms: resolution, backlash on a reversal and on a circle, kinematics, blocks."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.errors import contour_distances, contour_error, following_error, lost_steps
from trochia.backends import Twin
from trochia.backends import twin as module
from trochia.errors import ConfigError
from trochia.machine.kinematics import Cartesian, CoreXY
from trochia.recorder import gather, read, write


def run(twin, motion):
    return gather(twin.header(motion), twin.run(motion))


def test_exact_joints_follow_exactly(machine, joint, circle):
    bench = machine(joint("X"), joint("Y"))
    recording = run(Twin(machine=bench), circle(20, 2))
    assert all(figures.peak == 0 for figures in following_error(recording).values())
    assert contour_error(recording).peak == 0


def test_three_signals_are_independent(machine, joint, triangle):
    """Command in doubles, an encoder that counts the motor, and the load behind the backlash."""
    bench = machine(joint("X", steps=200, counts=64, backlash=0.1))
    recording = run(Twin(machine=bench), triangle(10))
    top = int(np.argmax(recording["X.commanded"]))
    np.testing.assert_array_equal(recording["joint.X.counts"], recording["joint.X.steps"] * 64 // 200)
    np.testing.assert_array_equal(recording["joint.X.motor"], recording["joint.X.steps"] / 200)
    assert recording["joint.X.counts"][top] == 640
    assert recording["X.actual"][top] == pytest.approx(9.95, abs=1e-12)


@pytest.mark.parametrize(("slack", "first"), [(0, 0), (-1, -0.05), (1, 0.05), (0.5, 0.025)])
def test_backlash_on_a_reversal(machine, joint, triangle, slack, first):
    """Up the load hangs b/2 behind, down b/2 ahead: peak error b/2, b between the two ways over one place."""
    recording = run(Twin(machine=machine(joint("X", backlash=0.1)), slack=slack), triangle(10))
    error = recording["X.actual"] - recording["X.commanded"]
    assert error[0] == pytest.approx(first)
    assert error[-1] == pytest.approx(0.05)
    assert following_error(recording)["X"].peak == pytest.approx(0.05)
    up, down = error[400], error[1600]  # 4 mm on both ways
    assert (up, down) == (pytest.approx(-0.05), pytest.approx(0.05))


def test_backlash_at_a_reversal_holds_the_load_for_its_whole_width(machine, joint, triangle):
    recording = run(Twin(machine=machine(joint("X", backlash=0.1))), triangle(10))
    still = np.flatnonzero(np.abs(recording["X.actual"] - 9.95) < 1e-9)
    assert recording.time[still[-1]] - recording.time[still[0]] == pytest.approx(0.1 / 10, abs=1e-9)


def test_circle_with_backlash_has_the_quadrant_steps(machine, joint, circle):
    """Each axis is b/2 behind its motion, so the radius is off by b/2 (cos - sin) of the angle past each quadrant.

    That is -b/2 before a quadrant and b/2 after it: a step of b, and while the dead zone is crossed one axis stands
    still.  Between quadrants the error lies along the circle, where it is none of the contour.
    """
    width, radius = 0.04, 20.0
    bench = machine(joint("X", backlash=width), joint("Y", backlash=width))
    recording = run(Twin(machine=bench), circle(radius, 2))
    angle = 2 * np.pi * recording.time
    x, y = recording["X.actual"], recording["Y.actual"]
    past = angle % (np.pi / 2)
    dead = np.arccos(1 - width / radius)  # angle past a quadrant at which the dead zone is crossed
    later = angle > np.pi / 2  # the start is centred
    radial = np.hypot(x, y) - radius
    expected = width / 2 * (np.cos(past) - np.sin(past))
    behind = later & (past > dead + 1e-6)
    second_order = width**2 / (4 * radius)
    np.testing.assert_allclose(radial[behind], expected[behind], atol=1.01 * second_order)
    crossing = later & (angle % np.pi < dead - 1e-6)
    np.testing.assert_allclose(np.abs(x[crossing]), radius - width / 2, atol=1e-9)
    figures = contour_error(recording)
    assert figures.peak == pytest.approx(width / 2, abs=2 * second_order)
    distances = contour_distances(recording)
    np.testing.assert_allclose(distances[later], np.abs(radial[later]), atol=1e-9)


def test_stepper_errs_by_less_than_a_step_and_loses_none(machine, joint, triangle):
    bench = machine(joint("X", steps=50), period=0.00037)
    recording = run(Twin(machine=bench), triangle(7.013))
    assert 0.9 / 50 < following_error(recording)["X"].peak < 1 / 50
    assert lost_steps(recording, bench) == {"X": 0}


def test_servo_errs_by_half_a_count(machine, joint, triangle):
    bench = machine(joint("X", counts=100), period=0.00037)
    recording = run(Twin(machine=bench), triangle(7))
    assert following_error(recording)["X"].peak == pytest.approx(0.005, abs=1e-4)
    assert "joint.X.steps" not in recording
    assert lost_steps(recording, bench) == {}


def test_encoder_on_the_load_sees_the_lost_motion(machine, joint, triangle):
    bench = machine(joint("X", steps=1000, counts=1000, backlash=0.1, on_load=True))
    recording = run(Twin(machine=bench), triangle(10))
    top = int(np.argmax(recording["X.commanded"]))
    assert recording["joint.X.counts"][top] == 9950
    assert recording["joint.X.steps"][top] == 10_000


def test_corexy_joints_and_back(machine, joint, circle):
    bench = machine(joint("A"), joint("B"), kinematics=CoreXY(2))
    recording = run(Twin(machine=bench), circle(20, 1))
    x, y = recording["X.commanded"], recording["Y.commanded"]
    np.testing.assert_allclose(recording["joint.A.motor"], x + y, atol=1e-12)
    np.testing.assert_allclose(recording["joint.B.motor"], x - y, atol=1e-12)
    np.testing.assert_allclose(recording["X.actual"], x, atol=1e-12)


def test_backlash_of_one_belt_moves_both_axes(machine, joint, circle):
    bench = machine(joint("A", backlash=0.1), joint("B"), kinematics=CoreXY(2))
    recording = run(Twin(machine=bench), circle(20, 1))
    errors = following_error(recording)
    assert (errors["X"].peak, errors["Y"].peak) == (pytest.approx(0.025), pytest.approx(0.025))


def test_gantry_stands_where_the_mean_of_its_joints_does(machine, joint, triangle):
    bench = machine(joint("X1", backlash=0.1), joint("X2"), kinematics=Cartesian((0, 0), 1))
    recording = run(Twin(machine=bench), triangle(10))
    mean = (recording["joint.X1.actual"] + recording["joint.X2.actual"]) / 2
    np.testing.assert_allclose(recording["X.actual"], mean, atol=1e-12)
    assert following_error(recording)["X"].peak == pytest.approx(0.025)


def test_period_is_the_machines_or_the_one_asked_for(machine, joint, triangle):
    bench = machine(joint("X"), period=0.002)
    assert len(run(Twin(machine=bench), triangle(10))) == 1001
    assert len(run(Twin(machine=bench, period=0.0005), triangle(10))) == 4001


def test_rounding_of_the_duration_adds_no_sample(machine, joint, motion):
    """A sum of phases comes out a little above 2.1 s; that is 2100 periods of 1 ms, and the last sample is the end."""
    duration = sum([0.3] * 7) + 1e-12
    assert duration / 0.001 > 2100
    ramp = motion(duration, lambda t: t[:, None])
    recording = run(Twin(machine=machine(joint("X"))), ramp)
    assert len(recording) == 2101
    assert recording["X.commanded"][-1] == duration


def test_blocks_of_any_size_give_the_same_recording(machine, joint, circle, monkeypatch):
    bench = machine(joint("X", steps=123, backlash=0.03, counts=77), joint("Y", counts=400, backlash=0.1))
    whole = run(Twin(machine=bench, slack=-0.7), circle(20, 1.3))
    for size in (1, 7, 1000):
        monkeypatch.setattr(module, "BLOCK", size)
        pieces = run(Twin(machine=bench, slack=-0.7), circle(20, 1.3))
        for name, samples in whole.channels.items():
            np.testing.assert_array_equal(pieces[name], samples, err_msg=name)


def test_a_run_goes_to_disk_block_by_block(machine, joint, circle, tmp_path):
    twin = Twin(machine=machine(joint("X", steps=200), joint("Y", steps=200)))
    write(tmp_path / "run", twin.header(circle(20, 1), program="circle.ngc"), twin.run(circle(20, 1)))
    recording = read(tmp_path / "run", verify=True)
    assert recording.program == "circle.ngc"
    np.testing.assert_array_equal(recording["X.actual"], run(twin, circle(20, 1))["X.actual"])


@pytest.mark.parametrize(("key", "value"), [("period", 0.0), ("period", float("nan")), ("slack", 1.5)])
def test_impossible_settings_are_refused(machine, joint, key, value):
    with pytest.raises(ConfigError, match=key):
        Twin(machine=machine(joint("X")), **{key: value})
