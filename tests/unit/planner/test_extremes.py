"""What programs and machines should not ask for, and do: each is kept inside the limits, or refused by name."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import PROFILES, plan
from trochia.toolpath import build

MILL = load("reference-mill")
PLAIN = ["trapezoid", "s-curve"]


def planned(text, profile):
    program = gcode.read(text + "\nM2\n")
    path = build(program, MILL, continuity=PROFILES[profile].continuity)
    return plan(path, MILL, program=program, profile=profile)


def assert_within_limits(trajectory):
    times = np.linspace(0.0, trajectory.duration, 5001)
    for name, values in (("velocity", trajectory.velocity(times)), ("acceleration", trajectory.acceleration(times))):
        most = np.array([getattr(axis, name) for axis in MILL.axes])
        assert (np.abs(values) <= most * (1 + 1e-9)).all()


@pytest.mark.parametrize("profile", PLAIN)
def test_micro_segments_below_the_tolerance_are_run_through(profile):
    points = np.round(np.cumsum(np.random.default_rng(1).normal(size=(2000, 2)) * 1e-4, axis=0), 6)
    lines = "\n".join(f"G1 X{x:.6f} Y{y:.6f}" for x, y in points)
    trajectory = planned(f"G64 P0.5\nF600\n{lines}", profile)
    assert_within_limits(trajectory)
    assert trajectory.position([trajectory.duration])[0, :2] == pytest.approx(points[-1], abs=1e-9)


@pytest.mark.parametrize("profile", PLAIN)
def test_a_tolerance_larger_than_the_moves_and_moves_of_no_length(profile):
    trajectory = planned("G64 P5\nF600\nG1 X1\nX1\nY1\nG0 Y1\nX0\nY0\nX0 Y0", profile)
    assert_within_limits(trajectory)
    assert trajectory.duration < planned("G61.1\nF600\nG1 X1\nY1\nX0\nY0", profile).duration


@pytest.mark.parametrize("profile", PLAIN)
def test_feeds_beyond_an_axis_are_slowed_and_named(profile):
    trajectory = planned("G61.1\nG1 X40 F6000\nG1 Z50 F9000\nX0 F15000", profile)
    assert [int(trajectory.program.moves["line"][row]) for row in trajectory.slowed] == [3, 4]
    assert_within_limits(trajectory)


@pytest.mark.parametrize("wrong", [0.0, -1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("limit", ["velocity", "acceleration", "jerk"])
def test_a_limit_that_is_none_is_refused_by_its_key(limit, wrong):
    axis = MILL.axes[0]
    with pytest.raises(ConfigError, match=rf"axes.X.{limit}: must be above zero"):
        dataclasses.replace(MILL, axes=(dataclasses.replace(axis, **{limit: wrong}), *MILL.axes[1:]))
