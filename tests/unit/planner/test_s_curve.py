"""The jerk-limited profile against closed forms: every shape the seven phases can take, and what it refuses."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from trochia.errors import LimitError
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan, profile_of
from trochia.toolpath import build

MILL = load("reference-mill")  # X and Y: 200 mm/s, 800 mm/s², 20,000 mm/s³
A, J = 800.0, 20_000.0


def planned(text, machine=MILL):
    program = gcode.read(f"G21 G90\n{text}\nM2\n")
    return plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve")


def phases_of(trajectory):
    return np.concatenate(list(trajectory.blocks()))


# length and feed -> time; with A reached (v J >= A²: v >= 32 mm/s) or not, with a stretch at the feed or not
SHAPES = {
    "all seven phases": (100.0, 50.0, 100 / 50 + 50 / A + A / J),
    "six: the feed just reached": (50 * (50 / A + A / J), 50.0, 2 * (50 / A + A / J)),
    "five: A just reached": (10.0, 32.0, 10 / 32 + 2 * math.sqrt(32 / J)),
    "five: A not reached": (10.0, 20.0, 10 / 20 + 2 * math.sqrt(20 / J)),
    "four: neither feed nor A": (1.0, 100.0, 4 * (1 / (2 * J)) ** (1 / 3)),
}
# A reached, the feed not: v² / A + v A / J = length
PEAK = (-A * A / J + math.sqrt((A * A / J) ** 2 + 4 * A * 10)) / 2
SHAPES["six: A reached, feed not"] = (10.0, 150.0, 2 * (PEAK / A + A / J))


@pytest.mark.parametrize(("length", "feed", "time"), SHAPES.values(), ids=SHAPES)
def test_a_line_from_rest_to_rest(length, feed, time):
    trajectory = planned(f"G61\nG1 X{length!r} F{feed * 60!r}")
    assert trajectory.duration == pytest.approx(time, rel=1e-9)
    moving = phases_of(trajectory)
    assert set(np.round(np.abs(moving["j"]))) <= {0.0, J}
    assert np.abs(moving["a"]).max() <= A * (1 + 1e-12)


def test_a_square_with_exact_stops_takes_its_formula():
    side = 40 / 100 + 100 / A + A / J
    assert planned("G61.1\nG1 X40 F6000\nY40\nX0\nY0").duration == pytest.approx(4 * side, abs=1e-9)


def test_motion_does_not_stop_between_lines_of_one_direction():
    whole, parts = planned("G61\nG1 X60 F6000"), planned("G61\nG1 F6000\n" + "\n".join(f"X{x}" for x in range(1, 61)))
    assert parts.duration == pytest.approx(whole.duration, rel=1e-9)


def test_a_ramp_of_many_lines_does_not_crumble():
    lines = "\n".join(f"G1 X{x / 10:.1f}" for x in range(1, 1001))
    trajectory = planned(f"G61\nF12000\n{lines}")
    assert trajectory.duration == pytest.approx(100 / 200 + 200 / A + A / J, rel=1e-9)


def test_a_faster_move_after_a_slower_begins_to_speed_up_at_its_start():
    trajectory = planned("G61\nG1 X20 F1200\nX120 F6000")
    speed = trajectory.path_speed(trajectory.schedule._ramps.knots["t"])
    assert speed.max() == pytest.approx(100.0)
    time = 20 / 20 + math.sqrt(20 / J)  # from rest to 20 mm/s, and on: half of the ramp's time is lost
    up = 80 / A + A / J
    down = 100 / A + A / J
    time += up + (100 - up * 60 - down * 50) / 100 + down
    assert trajectory.duration == pytest.approx(time, rel=1e-7)


def test_motion_stops_where_curvature_jumps_and_no_tolerance_lets_it_pass():
    trajectory = planned("G61\nF3000\nG1 X20\nG3 X30 Y10 J10\nG1 Y30")
    ends = np.cumsum(trajectory.path.segments["length"])
    slow = trajectory.path_speed(trajectory.schedule._ramps.knots["t"]) < 1e-9
    assert slow.sum() >= 4
    assert ends[-1] == pytest.approx(40 + 5 * math.pi)


def test_rests_stand_between_their_moves():
    trajectory = planned("G61\nG1 X10 F3000\nG4 P0.25\nX20\nG4 P0.5")
    rests = [phase for phase in phases_of(trajectory) if phase["flags"] & 1]
    assert [float(rest["duration"]) for rest in rests] == pytest.approx([0.25, 0.5])
    assert trajectory.position([rests[0]["t"], rests[1]["t"]])[:, 0] == pytest.approx([10.0, 20.0])
    assert trajectory.duration == pytest.approx(trajectory.times["motion"] + 0.75)


def test_a_feed_above_what_the_axis_can_is_told():
    trajectory = planned("G61\nG1 Z90 F60000\nG1 X90 F600")
    assert list(trajectory.slowed) == [0]


def test_jerk_missing_is_refused_by_name():
    axes = tuple(dataclasses.replace(axis, jerk=None) if axis.name == "Y" else axis for axis in MILL.axes)
    with pytest.raises(LimitError, match="axis Y"):
        planned("G61\nG1 X1 F600", dataclasses.replace(MILL, axes=axes))


def test_the_profile_is_the_smoothest_the_machine_can():
    axes = tuple(dataclasses.replace(axis, jerk=None) for axis in MILL.axes)
    assert profile_of(MILL) == "s-curve"
    assert profile_of(dataclasses.replace(MILL, axes=axes)) == "trapezoid"
    assert profile_of(dataclasses.replace(MILL, profile="trapezoid")) == "trapezoid"
    assert profile_of(MILL, "trapezoid") == "trapezoid"


def overlapping(text):
    program = gcode.read(f"G21 G90\n{text}\nM2\n")
    path = build(program, MILL, continuity=2, overlap=True)
    return plan(path, MILL, program=program, profile="s-curve")


def test_a_square_of_overlapping_corners_saves_what_its_moves_share():
    trajectory = overlapping("G64 P0.01\nG1 X40 F6000\nY40\nX0\nY0")
    side = 40 / 100 + 100 / A + A / J
    shared = (48 * 0.01 / math.sqrt(2) / J) ** (1 / 3)  # motion along both sides of a corner at once
    assert trajectory.duration == pytest.approx(4 * side - 3 * shared, rel=1e-3)
    assert trajectory.duration >= 4 * side - 3 * shared - 1e-9
    assert not (trajectory.path_speed(np.linspace(0.1, trajectory.duration - 0.1, 500)) == 0.0).any()


def test_acceleration_of_the_axes_goes_on_through_an_overlapping_corner():
    trajectory = overlapping("G64 P0.01\nG1 X5 F6000\nY5")
    times = np.linspace(0.0, trajectory.duration, 20_001)
    steps = np.abs(np.diff(trajectory.acceleration(times), axis=0)).max()
    assert steps <= J * (times[1] - times[0]) * (1 + 1e-6)


@pytest.mark.parametrize("first", [0.03, 0.1, 0.3, 1.0, 3.0])
def test_an_overlapping_corner_beside_a_short_line_is_reached_from_rest(first):
    short = overlapping(f"G64 P0.01\nG1 X{first} F6000\nY40")
    stops = planned(f"G61.1\nG1 X{first} F6000\nY40")
    assert short.duration < stops.duration
    assert max(v for v in short.peaks["X"].values() if v is not None) <= J * (1 + 1e-9)
