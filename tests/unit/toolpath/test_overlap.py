"""Corners of lines as the overlap of their moves, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.toolpath import SegmentKind, build

MILL = load("reference-mill")


def path_of(text, machine=MILL):
    return build(gcode.read(text + "\nM2\n"), machine, continuity=2, overlap=True)


def cubics(path):
    return np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)


@pytest.mark.parametrize("degrees", [40, 90, 150, 175])
def test_a_corner_is_one_cubic_that_touches_its_tolerance(degrees):
    angle, tolerance = math.radians(degrees), 0.02
    path = path_of(f"G64 P{tolerance}\nG1 X50 F6000\nX{50 + 50 * math.cos(angle):.15f} Y{50 * math.sin(angle):.15f}")
    (row,) = cubics(path)
    jump = 2 * math.sin(angle / 2)
    length = path.segments["length"][row]
    assert length == pytest.approx(24 * tolerance / jump, rel=1e-9)
    rows, s = np.array([row, row, row]), np.array([0.0, length / 2, length])
    place, slope, bend = (path.points(rows, s, order) for order in range(3))
    assert np.linalg.norm(place[1] - [50, 0, 0]) == pytest.approx(tolerance, rel=1e-9)
    before, after = np.array([1.0, 0, 0]), np.array([math.cos(angle), math.sin(angle), 0])
    assert place[[0, 2]] == pytest.approx(np.array([[50, 0, 0] - before * length / 3, [50, 0, 0] + after * length / 3]))
    assert slope[[0, 2]] == pytest.approx(np.array([before, after]), abs=1e-9)
    assert bend[[0, 2]] == pytest.approx(np.array([-before, after]) * 2 / length, abs=1e-9)
    assert len(path) == 3


def test_a_shallow_corner_keeps_its_bend_continuous():
    path = path_of("G64 P0.02\nG1 X50 F600\nX100 Y5")
    assert np.abs(path.points(cubics(path)[:1], np.zeros(1), 2)).max() == 0.0


def test_lines_that_are_short_for_it_keep_their_bend_continuous():
    # the triangle's legs, 6 P / |m| = 0.042 mm, are more than half of the shorter lines
    for size, kinds in ((0.05, 2), (0.3, 1)):
        path = path_of(f"G64 P0.01\nG1 X{size} F600\nY{size}")
        assert len(cubics(path)) == kinds


def test_a_small_overlap_gives_way_to_a_chain_beside_it():
    angles = np.radians(np.arange(0, 91, 1.0))
    chords = "\n".join(f"X{20 * math.cos(a):.12f} Y{20 * math.sin(a):.12f}" for a in angles[1:])
    path = path_of(f"G64 P0.01\nF6000\nG1 X20\n{chords}")
    assert np.isclose(path.points(cubics(path), 0.0 * cubics(path), 2)[0], 0.0).all()


def test_each_side_of_an_overlap_keeps_its_feed():
    path = path_of("G64 P0.01\nG1 X10 F6000\nY10 F5998")
    rows = cubics(path)
    assert list(path.segments["speed_limit"][rows]) == pytest.approx([100.0, 5998 / 60])
    assert list(path.segments["move"][rows]) == [0, 1]


def test_an_overlap_beside_a_slow_move_is_short():
    long, short = (path_of(f"G64 P0.5\nG1 X40 F6000\nY40 F{feed}") for feed in (6000, 60))
    assert short.segments["length"][cubics(short)].sum() < 0.1 * long.segments["length"][cubics(long)].sum()


def test_a_corner_that_a_slow_feed_passes_anyhow_is_no_overlap():
    slow = path_of("G64 P0.5\nG1 X50 F60\nY50")
    assert len(cubics(slow)) == 2
    line = gcode.read("G1 X100 F60\nM2\n")
    straight = plan(build(line, MILL, continuity=2), MILL, program=line, profile="s-curve").duration
    assert plan(slow, MILL, program=line, profile="s-curve").duration == pytest.approx(straight, rel=1e-6)


@pytest.mark.parametrize("degrees", [3, 10, 20, 30, 60, 90, 135, 170])
@pytest.mark.parametrize("tolerance", [0.0001, 0.003, 0.2])
def test_a_corner_is_taken_as_it_costs_least(degrees, tolerance):
    angle = math.radians(degrees)
    for size, feed in ((1.0, 300), (10.0, 60), (40.0, 6000)):
        zig = "\n".join(f"X{k * size * math.cos(angle / 2):.12f} Y{k % 2 * size * math.sin(angle / 2):.12f}"
                        for k in range(1, 10))  # fmt: skip
        times = []
        for mode, overlap in ((f"G64 P{tolerance}", True), (f"G64 P{tolerance}", False), ("G61.1", True)):
            program = gcode.read(f"{mode}\nG1 F{feed}\n{zig}\nM2\n")
            path = build(program, MILL, continuity=2, overlap=overlap)
            times.append(plan(path, MILL, program=program, profile="s-curve").duration)
        assert times[0] <= min(times[1:]) * 1.002


def test_an_overlap_is_passed_where_the_next_corner_bends_the_rest_of_its_line():
    heading = np.radians(60 + 2.0 * np.arange(60))
    ends = np.array([20.0, 0.0]) + 0.5 * np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)
    chords = "\n".join(f"X{x:.12f} Y{y:.12f}" for x, y in ends)
    program = gcode.read(f"G64 P0.003\nF6000\nG1 X20\n{chords}\nM2\n")
    path = build(program, MILL, continuity=2)
    assert (path.segments["kind"][1:3] == SegmentKind.CUBIC).all()
    rows = np.array([1, 2])
    assert np.abs(np.diff(path.points(rows, np.array([path.segments["length"][1], 0.0]), 2), axis=0)).max() > 1.0
    trajectory = plan(path, MILL, program=program, profile="s-curve")
    speeds = [float(v) for block in trajectory.blocks() for v in block["v"]]
    assert min(speeds[1:]) > 1.0


def test_program_and_corners_stay_inside_their_memory():
    text = "G64 P0.01\nF600\n" + "\n".join(f"G1 X{k % 2 * 10 + k // 4} Y{k // 2 % 2 * 10 + k // 4}" for k in range(400))
    program = gcode.read(text + "\nM2\n")
    path = build(program, MILL, continuity=2, overlap=True)
    assert program.moves.nbytes + path.segments.nbytes + path.pool.nbytes <= 400 * len(program.moves)
