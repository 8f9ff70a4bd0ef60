"""Servo joints in the twin against closed forms of their loops: lag, feed-forward, kinematics, sampling, blocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.errors import contour_distances, following_error
from trochia.backends import Twin
from trochia.backends import twin as module
from trochia.machine.load import load, loads
from trochia.recorder import gather

TABLE = """\
format = 1
name = "bench"
kinematics = "cartesian"
servo_period = "0.5 ms"
[axes.X]
minimum = "-100 mm"
maximum = "100 mm"
velocity = "200 mm/s"
acceleration = "5000 mm/s²"
[axes.Y]
minimum = "-100 mm"
maximum = "100 mm"
velocity = "200 mm/s"
acceleration = "5000 mm/s²"
"""
JOINT = """
[joints.{name}]
transmission = {{ kind = "leadscrew", lead = "10 mm" }}
amplifier = {{ mode = "current", command = "10 V", current = "20 A" }}
[joints.{name}.motor]
kind = "servo"
[joints.{name}.motor.catalogue]
kind = "dc"
resistance = "1 ohm"
inertia = "1 kg·cm²"
torque_constant = "0.1 N·m/A"
[joints.{name}.loop]
kind = "cascade"
position_gain = "{gain} 1/s"
speed_gain = "0.15 V·s/rad"
{more}
"""


def bench(gains=(50, 50), more="", text=TABLE):
    return loads(text + "".join(JOINT.format(name=n, gain=g, more=more) for n, g in zip("XY", gains, strict=True)))


def run(machine, motion, **how):
    twin = Twin(machine=machine, **how)
    return gather(twin.header(motion), twin.run(motion))


@pytest.fixture
def steady(motion):
    """Return a motion of both axes that starts gently and then goes on at 40 and 30 mm/s."""

    def place(t):
        way = np.where(t < 0.2, 0.5 * t * t / 0.2, t - 0.1)
        return way[:, None] * np.array([40.0, 30.0])

    return motion(1.0, place)


def test_lag_at_a_steady_speed_is_speed_over_gain(steady):
    """Without feed-forward a cascade with no friction lags by v/kp, and one of equal gains stays on its path."""
    recording = run(bench(), steady)
    error = recording["X.commanded"] - recording["X.actual"]
    assert error[-1] == pytest.approx(40 / 50, rel=1e-3)
    assert (recording["Y.commanded"] - recording["Y.actual"])[-1] == pytest.approx(30 / 50, rel=1e-3)
    assert contour_distances(recording).max() < 1e-5  # a hundred-thousandth of the lag


def test_unequal_gains_leave_the_path(steady):
    """Lags of 0.8 and 0.3 mm on a line at 4:3 are |0.8 · 3/5 - 0.3 · 4/5| off it."""
    recording = run(bench((50, 100)), steady)
    assert contour_distances(recording)[-1] == pytest.approx(0.8 * 0.6 - 0.3 * 0.8, rel=2e-3)


def test_feed_forward_takes_the_lag_away(steady):
    forward = "velocity_forward = 1\nacceleration_forward = 1\nfriction_forward = 1"
    plain, fed = (following_error(run(bench(more=more), steady))["X"].rms for more in ("", forward))
    assert fed < plain / 500


def test_a_circle_shrinks_by_the_loops_gain(circle):
    """Both axes as kp/(s + kp): radius 1/√(1 + (w/kp)²) at the rate w of the circle."""
    recording = run(bench(text=TABLE), circle(10, 4))
    late = recording.time > 2
    radius = np.hypot(recording["X.actual"], recording["Y.actual"])[late]
    w, kp, inner = 2 * np.pi, 50.0, 0.15 * 2 * 0.1 / 1e-4  # of the speed loop: Kt gain kv / J [1/s]
    response = kp / (kp + 1j * w * (1 + 1j * w / inner))
    assert radius.mean() == pytest.approx(10 * abs(response), rel=2e-4)
    assert np.ptp(radius) < 1e-4


def test_blocks_do_not_matter(steady, monkeypatch):
    whole = run(bench((50, 70)), steady)
    monkeypatch.setattr(module, "BLOCK", 37)
    cut = run(bench((50, 70)), steady)
    for name in whole.channels:
        np.testing.assert_array_equal(whole[name], cut[name])


@pytest.mark.parametrize("period", [0.3e-3, 2e-3, 5e-3])
def test_any_sampling_sees_the_same_motion(steady, period):
    machine = bench()
    fine, other = run(machine, steady), run(machine, steady, period=period)
    expected = np.interp(other.time, fine.time, fine["X.actual"])
    np.testing.assert_allclose(other["X.actual"], expected, atol=2e-4)


def test_a_machine_of_belts_runs_its_motors(motion):
    """On a CoreXY each motor lags by its own speed, and the axes by theirs."""
    text = TABLE.replace("cartesian", "corexy")
    machine = loads(text + "".join(JOINT.format(name=n, gain=50, more="") for n in "AB"))
    recording = run(machine, motion(1.0, lambda t: t[:, None] ** 2 * np.array([5.0, -3.0])))
    joint = recording["joint.A.motor"][-1] / (recording["X.actual"][-1] + recording["Y.actual"][-1])
    assert joint == pytest.approx(1, rel=1e-9)
    # v = 10 t, so the lag at the end is v/kp less a/kp², and the speed loop's share
    assert recording["X.commanded"][-1] - recording["X.actual"][-1] == pytest.approx(10 / 50, rel=0.03)


def test_ideal_joints_can_be_asked_for(steady):
    recording = run(bench(), steady, physical=False)
    assert following_error(recording)["X"].peak == 0
    assert "joint.X.current" not in recording


def test_backlash_follows_behind_the_loop(triangle):
    """With feed-forward the motor is on its command, and the load half a backlash off on either side."""
    forward = "velocity_forward = 1\nacceleration_forward = 1\nfriction_forward = 1"
    text = TABLE.partition("[axes.Y]")[0]
    one = loads(text + JOINT.format(name="X", gain=50, more=forward))
    machine = replace(one, joints=(replace(one.joints[0], backlash=0.1),))
    recording = run(machine, triangle(10))
    error = recording["X.actual"] - recording["X.commanded"]
    assert error[900] == pytest.approx(-0.05, abs=1e-3)
    assert error[-900] == pytest.approx(0.05, abs=1e-3)


def test_the_xy_tables_lag_without_velocity_feed_forward_is_its_derivative_time(motion):
    """Of the card's own table: 39 ms of velocity, so 1000 counts (its warning) are passed at 6.3 mm/s."""
    table = load("xy-table")
    bare = replace(table, beam=None, joints=tuple(
        replace(joint, loop=replace(joint.loop, i32=0, i35=0, i65=0), load=replace(joint.load, friction=0.0),
                train=replace(joint.train, viscous=0.0), motor=replace(
                    joint.motor, catalogue=replace(joint.motor.catalogue, friction=0.0)))
        for joint in table.joints))  # fmt: skip
    recording = run(bare, motion(1.5, lambda t: 6 * (t - 0.2 * np.tanh(t / 0.2))[:, None] * np.array([1.0, 0.0])))
    lag = (recording["X.commanded"] - recording["joint.X.measured"])[-1]
    assert lag / 6 == pytest.approx(11280 * 442e-6 / 128, rel=0.01)  # Ix31 T / 128 = 39 ms
