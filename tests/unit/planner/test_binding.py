"""What binds where, on motions whose limits are known by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.axes import PathLimits
from trochia.machine.load import load
from trochia.planner import PROFILES, plan
from trochia.planner.binding import Kind
from trochia.toolpath import build

MILL = load("reference-mill")  # X, Y: 200 mm/s, 800 mm/s², 20000 mm/s³; Z: 100, 400


def planned(text, machine=MILL, profile="trapezoid"):
    program = gcode.read(text + "\nM2\n")
    path = build(program, machine, continuity=PROFILES[profile].continuity)
    return plan(path, machine, program=program, profile=profile)


def words(trajectory, *times):
    return trajectory.binding(times).words()


def test_a_line_speeds_up_by_acceleration_and_then_keeps_its_feed():
    trajectory = planned("G1 X100 F3000")
    binding = trajectory.binding([0.03, 1.0, trajectory.duration - 0.03])
    assert binding.words() == ["axis X acceleration", "programmed feed", "axis X acceleration"]
    assert binding.used == pytest.approx([1, 1, 1])


def test_a_rapid_is_bound_by_the_axis_it_asks_most_of():
    trajectory = planned("G0 X300 Z300")
    assert words(trajectory, 0.1, trajectory.duration / 2) == ["axis Z acceleration", "axis Z velocity"]


def test_a_jerk_limited_line_begins_with_jerk():
    trajectory = planned("G1 X100 F6000", profile="s-curve")
    assert words(trajectory, 0.02, 0.08, 1.0) == ["axis X jerk", "axis X acceleration", "programmed feed"]


def test_an_arc_is_bound_by_its_bend():
    trajectory = planned("G2 X0 Y0 I10 J0 F60000")
    middle = trajectory.binding([trajectory.duration / 2])
    assert middle.kind[0] == Kind.CURVATURE
    assert middle.used[0] > 0.98


def test_caps_on_the_vector_bind_before_the_axes():
    capped = dataclasses.replace(MILL, path=PathLimits(velocity=50.0, acceleration=100.0))
    trajectory = planned("G1 X100 Y100 F6000", capped)
    assert words(trajectory, 0.1, trajectory.duration / 2) == ["path acceleration cap", "path velocity cap"]


def test_a_dwell_is_a_rest():
    trajectory = planned("G1 X10 F600\nG4 P1\nG1 X20")
    assert words(trajectory, trajectory.duration / 2) == ["at rest"]
    assert planned("G4 P1").binding([0.5]).words() == ["at rest"]


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_no_segment_is_shorter_than_the_drive_takes(profile):
    slow = dataclasses.replace(MILL, segment_time=0.01)
    turns = 0.004 * np.arange(1, 100)  # chords of 0.2 mm on 50 mm, which Q may not merge
    points = np.stack([50 * np.sin(turns), 50 - 50 * np.cos(turns)], axis=1)
    text = "G64 P0.01 Q0.000001\nF6000\n" + "\n".join(f"G1 X{x:.5f} Y{y:.5f}" for x, y in points)
    trajectory = planned(text, slow, profile)
    phases = np.concatenate(list(trajectory.blocks()))
    times = np.bincount(phases["segment"], phases["duration"])
    assert times.min() >= 0.01 * (1 - 1e-9)
    assert trajectory.duration > planned(text, MILL, profile).duration
    assert trajectory.slowed.size
    kinds = trajectory.binding(np.linspace(0.2, trajectory.duration - 0.2, 50)).kind
    assert np.count_nonzero(kinds == Kind.DRIVE) >= 5


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_nothing_is_used_beyond_its_limit(profile):
    trajectory = planned("G64 P0.05\nF9000\nG1 X30\nG3 X40 Y10 J10\nG1 Y30\nX0 Y31\nG0 X0 Y0 Z5", profile=profile)
    used = trajectory.binding(np.linspace(0, trajectory.duration, 5001)).used
    assert used.max() <= 1 + 1e-9
    assert used.mean() > 0.9
