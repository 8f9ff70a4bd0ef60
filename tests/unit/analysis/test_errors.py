from __future__ import annotations

import sys
from fractions import Fraction

import numpy as np
import pytest

from trochia.analysis import errors
from trochia.analysis.errors import contour_distances, contour_error, following_error, lost_steps
from trochia.machine.axes import Axis, AxisKind, PathLimits
from trochia.machine.joints import Joint, Servo, Stepper
from trochia.machine.kinematics import CoreXY
from trochia.machine.machine import Machine
from trochia.machine.transmissions import Leadscrew
from trochia.recorder import Channel, Header, Recording


def recording(commanded, actual, axes="XYZ", unit="mm", **more):
    samples = dict(more)
    for i, axis in enumerate(axes[: commanded.shape[1]]):
        samples |= {f"{axis}.commanded": commanded[:, i].copy(), f"{axis}.actual": actual[:, i].copy()}
    channels = tuple(Channel(name=name, unit=unit) for name in samples)
    return Recording(header=Header(period=0.001, channels=channels), channels=samples)


def circle(t, radius=20.0, omega=3.0):
    return radius * np.stack([np.cos(omega * t), np.sin(omega * t)], axis=1)


def test_following_error_of_a_lag_is_speed_times_lag():
    """A circle followed lag seconds late: each axis errs by a sine of amplitude 2 r sin(omega lag / 2)."""
    t = np.linspace(0, 2 * np.pi / 3, 6000, endpoint=False)  # one turn
    figures = following_error(recording(circle(t), circle(t - 0.01)))
    amplitude = 2 * 20 * np.sin(3 * 0.01 / 2)
    for axis in "XY":
        assert figures[axis].peak == pytest.approx(amplitude, rel=1e-6)
        assert figures[axis].rms == pytest.approx(amplitude / np.sqrt(2), rel=1e-12)


def test_contour_error_of_a_lag_is_none_and_of_a_radius_is_the_radius():
    t = np.arange(0, 4, 0.001)
    late = recording(circle(t), circle(t - 0.01))
    assert contour_distances(late)[11:].max() < 1e-9
    small = recording(circle(t), circle(t - 0.01, radius=19.97))
    np.testing.assert_allclose(contour_distances(small)[11:], 0.03, atol=1e-9)


def test_contour_error_of_a_first_order_lag_is_the_shrunken_circle():
    """A loop of gain k makes the radius smaller by 1 / sqrt(1 + (omega / k)²), whatever its phase lag."""
    t = np.arange(0, 4, 0.001)
    gain, omega, radius = 60.0, 3.0, 20.0
    shrunk = radius / np.sqrt(1 + (omega / gain) ** 2)
    late = np.arctan(omega / gain) / omega
    made = recording(circle(t), circle(t - late, radius=shrunk))
    np.testing.assert_allclose(contour_distances(made)[30:], radius - shrunk, atol=1e-9)


def test_peak_has_its_sample_and_rms_its_definition():
    t = np.arange(0, 1, 0.001)
    actual = circle(t)
    actual[321] *= 1 + 0.05 / 20
    figures = contour_error(recording(circle(t), actual))
    assert (figures.peak, figures.at) == (pytest.approx(0.05, abs=1e-9), 321)
    assert figures.rms == pytest.approx(0.05 / np.sqrt(1000), abs=1e-9)


def test_windows_give_what_the_whole_gives(monkeypatch):
    t = np.arange(0, 3, 0.001)
    made = recording(circle(t), circle(t - 0.01, radius=20.01))
    whole = contour_distances(made)
    monkeypatch.setattr(errors, "MARGIN", 64)
    monkeypatch.setattr(sys.modules["trochia.recorder.figures"], "BLOCK", 500)
    figures = contour_error(made)
    # the cubic at a window's ends is another one than inside, by less than a nanometre
    assert figures.peak == pytest.approx(whole.max(), abs=1e-6)
    assert figures.rms == pytest.approx(np.sqrt(np.mean(whole**2)), rel=1e-9)


def test_only_linear_axes_span_the_contour_unless_named():
    t = np.arange(0, 1, 0.001)
    turning = recording(circle(t), circle(t, radius=25), unit="degree")
    assert contour_error(turning).peak == 0
    assert contour_error(turning, axes="XY").peak == pytest.approx(5, abs=1e-9)
    assert following_error(turning)["X"].peak == pytest.approx(5)


def belts(second):
    screw = Leadscrew(lead=Fraction(2))
    axes = tuple(
        Axis(name=name, kind=AxisKind.LINEAR, minimum=-50, maximum=50, velocity=1, acceleration=1) for name in "XY"
    )
    joints = (
        Joint(name="A", motor=Stepper(full_steps=200), transmission=screw),
        Joint(name="B", motor=second, transmission=screw),
    )
    return Machine(name="m", description="", axes=axes, joints=joints, kinematics=CoreXY(2), path=PathLimits())


@pytest.mark.parametrize(("short", "lost"), [(0.0, 0), (0.0099, 0), (0.01, 1), (-0.02, -2), (0.0399, 3), (0.04, 4)])
def test_lost_steps_are_whole_steps_behind_the_command(short, lost):
    """At 100 steps/mm; X = 3, Y = 1 puts the joints at 4 and 2."""
    end = np.array([[0.0, 0.0], [3.0, 1.0]])
    motors = {"joint.A.motor": np.array([0, 4 - short]), "joint.B.motor": np.array([0, 2.0])}
    made = recording(end, end, **motors)
    assert lost_steps(made, belts(Stepper(full_steps=200))) == {"A": lost, "B": 0}
    assert lost_steps(made, belts(Servo())) == {"A": lost}
