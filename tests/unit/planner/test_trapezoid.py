"""Trapezoids against closed forms."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from trochia.errors import LimitError
from trochia.languages import gcode
from trochia.machine.axes import PathLimits
from trochia.machine.load import load
from trochia.planner import Limits, plan
from trochia.toolpath import SegmentKind, build

MILL = load("reference-mill")


def read(text):
    return gcode.read(text if isinstance(text, bytes) else text + "\nM2\n")


def planned(text, machine=MILL):
    program = read(text)
    return plan(build(program, machine), machine, program=program)


def test_a_line_from_rest_to_rest():
    trajectory = planned("G1 X100 F3000")
    assert trajectory.duration == pytest.approx(2.0625, abs=1e-12)  # 100/50 + 50/800
    assert trajectory.times == {"motion": trajectory.duration, "dwell": 0, "spindle": 0, "tool": 0}
    assert trajectory.position([0, 1.03125, 2.0625])[:, 0] == pytest.approx([0, 50, 100])
    assert trajectory.path_speed([0.0, 0.03125, 1.0])[1:] == pytest.approx([25, 50])


def test_a_square_with_stops():
    assert planned("G61.1\nG1 X40 F6000\nY40\nX0\nY0").duration == pytest.approx(2.1, abs=1e-12)


def test_a_short_line_never_reaches_its_feed():
    assert planned("G1 X1 F6000").duration == pytest.approx(2 * math.sqrt(1 / 800), rel=1e-12)


def test_a_rapid_goes_as_fast_as_its_slowest_axis_lets_it():
    trajectory = planned("G0 X300 Z300")
    assert trajectory.duration == pytest.approx(300 / 100 + 100 / 400, rel=1e-12)
    assert trajectory.peaks["X"]["velocity"] == pytest.approx(100)
    assert trajectory.peaks["Z"] == pytest.approx({"velocity": 100, "acceleration": 400, "jerk": None})


def test_a_collinear_chain_is_one_line():
    chain = planned("F3000\n" + "\n".join(f"G1 X{k}" for k in range(1, 101)))
    assert chain.duration == pytest.approx(2.0625, rel=1e-9)


def test_a_change_of_feed_is_met_at_the_joint():
    trajectory = planned("G1 X50 F6000\nX100 F600")
    brake = (100**2 - 10**2) / 1600
    whole = 100 / 800 + (50 - 100**2 / 1600 - brake) / 100 + 90 / 800 + (50 - 10**2 / 1600) / 10 + 10 / 800
    assert trajectory.duration == pytest.approx(whole, rel=1e-9)


def test_a_corner_is_taken_at_the_speed_its_parabola_allows():
    trajectory = planned("G64 P0.01\nG1 X40 F6000\nY40")
    blend = int(np.flatnonzero(trajectory.path.segments["kind"] == SegmentKind.CUBIC)[0])
    d = 4 * 0.01 / math.sqrt(2)
    phases = np.concatenate(list(trajectory.blocks()))
    speed = phases["v"][phases["segment"] == blend]
    assert speed == pytest.approx([math.sqrt(800 * 2 * d)], rel=1e-9)  # |x''| = 1 / 2d on either axis


def test_a_small_circle_is_held_to_its_centripetal_acceleration():
    trajectory = planned("G3 X0 Y0 I2 F12000")
    t = np.linspace(0, trajectory.duration, 5000)
    assert trajectory.path_speed(t).max() <= math.sqrt(800 * 2 * math.sqrt(2)) * 1.001
    assert trajectory.path_speed(t).max() >= math.sqrt(800 * 2)
    assert trajectory.peaks["X"]["acceleration"] == pytest.approx(800, rel=0.01)


def test_a_path_cap_binds_the_vector():
    machine = dataclasses.replace(MILL, path=PathLimits(velocity=100.0, acceleration=500.0))
    assert planned("G0 X200 Y200", machine).duration == pytest.approx(200 * math.sqrt(2) / 100 + 0.2, rel=1e-9)
    circle = planned("G3 X0 Y0 I2 F12000", machine)
    t = np.linspace(0, circle.duration, 5000)
    assert circle.path_speed(t).max() == pytest.approx(math.sqrt(500 * 2), rel=0.01)


def test_belts_bind_through_the_kinematics():
    machine = load("corexy")
    joints = tuple(dataclasses.replace(j, velocity=200.0, acceleration=1000.0) if i < 2 else j
                   for i, j in enumerate(machine.joints))  # fmt: skip
    machine = dataclasses.replace(machine, joints=joints)
    diagonal, straight = planned("G0 X100 Y100", machine), planned("G0 X100", machine)
    # on the diagonal one belt does X + Y, so each axis has half of its speed and acceleration
    assert diagonal.duration == pytest.approx(100 / 100 + 100 / 500, rel=1e-9)
    assert straight.duration == pytest.approx(100 / 200 + 200 / 1000, rel=1e-9)


def test_limits_rows_begin_with_the_axes_and_merge_what_moves_alike():
    machine = load("corexy")
    joints = tuple(dataclasses.replace(j, velocity=10.0) for j in machine.joints)
    limits = Limits.of(dataclasses.replace(machine, joints=joints))
    assert limits.names == ("axis X", "axis Y", "joint pen", "joint belt-a", "joint belt-b")
    assert limits.velocity[2:] == pytest.approx([10, 10, 10])
    assert limits.matrix[3:].tolist() == [[1, 1, 0], [1, -1, 0]]


def test_rests_are_phases_and_itemised():
    machine = dataclasses.replace(MILL, spindle=dataclasses.replace(MILL.spindle, maximum=10000, spin_up=2.0),
                                  tool_change_time=5.0)  # fmt: skip
    trajectory = planned("T1 M6\nS5000 M3\nG1 X100 F3000\nG4 P0.5\nX200\nM4\nM2", machine)
    assert trajectory.times == pytest.approx({"motion": 2 * 2.0625, "dwell": 0.5, "spindle": 1 + 2 + 1, "tool": 5})
    assert trajectory.duration == pytest.approx(sum(trajectory.times.values()))
    phases = np.concatenate(list(trajectory.blocks()))
    rests = phases[phases["flags"] == 1]
    assert rests["duration"] == pytest.approx([6.0, 0.5, 3.0])
    assert phases["t"][1:] == pytest.approx(phases["t"][:-1] + phases["duration"][:-1])
    at = [3.0, 6 + 2.0625 + 0.25, trajectory.duration - 1]
    assert trajectory.position(at)[:, 0] == pytest.approx([0, 100, 200])
    assert not trajectory.velocity(at).any()
    assert (trajectory.states(at)["flags"] == 1).all()


def test_a_program_without_motion_takes_its_time():
    trajectory = planned("G4 P2\nM2")
    assert trajectory.duration == 2.0
    (block,) = trajectory.blocks()
    assert block["duration"].tolist() == [2.0]
    assert trajectory.position([0.0, 1.0]).tolist() == [[0, 0, 0], [0, 0, 0]]
    assert trajectory.line_at([1.0]).tolist() == [0]
    assert trajectory.slowed.size == 0
    assert not list(planned("M2").blocks())


def test_lines_and_move_times():
    trajectory = planned("G61.1\nG1 X100 F3000\n\nX100\nY100")
    assert trajectory.line_at([1.0, 3.0]).tolist() == [2, 5]
    assert trajectory.move_times == pytest.approx([2.0625, 0, 2.0625])


def test_feeds_above_a_limit_are_named():
    trajectory = planned("G61\nG1 X10 F60000\nY10 F6000\nG3 X0 Y0 I-5 J-5 F13000\nG0 X9")
    assert trajectory.slowed.tolist() == [0, 2]


def test_blocks_are_small_and_make_the_same_whole():
    trajectory = planned("F6000\n" + "\n".join(f"G1 X{k} Y{k % 2}" for k in range(1, 40)))
    whole, parts = list(trajectory.blocks()), list(trajectory.blocks(size=4))
    assert max(len(part) for part in parts) <= 4
    assert np.array_equal(np.concatenate(parts), np.concatenate(whole))
    with pytest.raises(ValueError, match="room for 4"):
        list(trajectory.blocks(size=3))


def test_outside_its_time_the_trajectory_stands():
    trajectory = planned("G1 X100 F3000")
    assert trajectory.position([-1, 99])[:, 0] == pytest.approx([0, 100])
    assert trajectory.velocity([-1, 99])[:, 0] == pytest.approx([0, 0])


def test_an_unknown_profile_is_refused():
    program = read("G0 X1")
    with pytest.raises(LimitError, match="no velocity profile 'magic'"):
        plan(build(program, MILL), MILL, program=program, profile="magic")
