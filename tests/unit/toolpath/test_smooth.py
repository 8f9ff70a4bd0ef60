"""Paths of continuous curvature against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.toolpath import SegmentKind, build

MILL = load("reference-mill")


def path_of(text, **options):
    return build(gcode.read(text + "\nM2\n"), MILL, continuity=2, overlap=False, **options)


def third(path, rows):
    """x''' of cubics."""
    at = path.segments["data"][rows].astype(int)[:, None] + 9 + np.arange(3)
    return 6 * path.pool[at]


def circle(radius, chords, decimals=12):
    angles = np.linspace(0, 2 * math.pi, chords + 1)[1:]
    points = np.round(radius * np.stack([np.cos(angles), np.sin(angles)], 1), decimals)
    return f"G64 P0.01\nF6000\nG0 X{radius}\n" + "\n".join(f"G1 X{x:.12f} Y{y:.12f}" for x, y in points)


@pytest.mark.parametrize("degrees", [10, 45, 90, 150])
def test_a_corner_turns_by_a_triangle_of_bend_and_touches_its_tolerance(degrees):
    angle, tolerance = math.radians(degrees), 0.02
    path = path_of(f"G64 P{tolerance}\nG1 X50 F600\nX{50 + 50 * math.cos(angle):.15f} Y{50 * math.sin(angle):.15f}")
    rows = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)
    jump = 2 * math.sin(angle / 2)
    leg = 6 * tolerance / jump
    assert path.segments["length"][rows] == pytest.approx([leg, leg], rel=1e-9)
    corner = path.points(rows[:1], np.array([leg]))[0]
    assert np.linalg.norm(corner - [50, 0, 0]) == pytest.approx(tolerance, rel=1e-9)
    assert np.linalg.norm(third(path, rows), axis=1) == pytest.approx([jump / leg**2] * 2, rel=1e-9)
    assert list(path.segments["stop"]) == [0, 0, 0, 1]


def test_a_circle_of_even_chords_bends_as_the_circle_does():
    radius = 20.0
    path = path_of(circle(radius, 360))
    rows = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)[4:-4]
    assert (path.segments["stop"][rows] == 0).all()
    assert np.linalg.norm(path.points(rows, 0.0 * rows, 2), axis=1) == pytest.approx(1 / radius, rel=1e-3)
    assert np.linalg.norm(third(path, rows), axis=1) == pytest.approx(1 / radius**2, rel=1e-3)


def test_a_circle_of_many_rounded_chords_does_not_shake():
    # 2400 chords of 0.05 mm on a grid of a micrometre: taken one by one, x''' is 200 times that of the circle
    radius = 20.0
    path = path_of(circle(radius, 2400, decimals=3))
    rows = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)[4:-4]
    assert path.merged > 2000
    assert np.median(np.linalg.norm(third(path, rows), axis=1)) < 4 / radius**2


def test_uneven_chords_cost_one_cubic_each_where_all_fits_the_tolerance():
    angles = np.cumsum(np.tile([0.01, 0.02, 0.015], 40))
    text = "\n".join(f"G1 X{50 * math.sin(a):.12f} Y{50 - 50 * math.cos(a):.12f}" for a in angles)
    path = path_of(f"G64 P0.1 Q0\nF600\n{text}")
    middle = (path.segments["move"] > 5) & (path.segments["move"] < 110)
    assert np.array_equal(path.segments["move"][middle], np.arange(6, 110))
    bend = np.linalg.norm(path.points(np.flatnonzero(middle), np.zeros(104), 2), axis=1)
    assert bend == pytest.approx(np.full(104, 1 / 50), rel=1e-3)


def test_exact_path_stops_where_bend_jumps():
    text = "G61\nG1 X10 F600\nX20\nG3 X30 Y10 J10\nX20 Y20 I-10"
    assert list(path_of(text).segments["stop"]) == [0, 1, 0, 1]  # line to line passes, line to arc not, arc to arc does


def test_with_a_tolerance_a_tangent_arc_is_entered_without_a_stop():
    path = path_of("G64 P0.01\nG1 X20 F600\nG3 X30 Y10 J10\nG1 Y30\nX10")
    assert list(np.flatnonzero(path.segments["stop"])) == [len(path) - 1]
    arcs = np.flatnonzero(path.segments["kind"] == SegmentKind.ARC)
    assert arcs.size == 1
    every = np.arange(len(path))
    starts, finishes = path.points(every, 0.0 * every, 2), path.points(every, path.segments["length"], 2)
    assert np.abs(starts[1:] - finishes[:-1]).max() < 1e-9


def test_moves_in_line_within_q_become_one():
    text = "F600\nG1 X1 Y0.001\nX2 Y0\nX3 Y0.001\nX4 Y0\nX5 F700\nX6\nX6 Y9\n"
    path = path_of("G64 P0.01 Q0.005\n" + text)
    assert path.merged == 4
    assert sorted(set(path.segments["move"])) == [0, 4, 6]
    assert path_of("G64 P0.01 Q0\n" + text).merged == 0
    assert path_of("G61\n" + text).merged == 0


def test_what_merging_takes_is_left_out_of_the_corner():
    # the middle point lies 0.002 off the line for which both stand; the corner has 0.008 left
    path = path_of("G64 P0.01\nF600\nG1 X25 Y0.002\nX50 Y0\nX50 Y50")
    assert path.merged == 1
    rows = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)
    corner = path.points(rows[1:2], np.zeros(1))[0]
    assert np.linalg.norm(corner - [50, 0, 0]) == pytest.approx(0.008, rel=1e-6)


def test_an_action_or_another_beam_power_keeps_moves_apart():
    assert path_of("G64 P0.1\nF600\nG1 X1\nM8\nX2").merged == 0
    assert path_of("G64 P0.1\nF600\nM3 S100\nG1 X1\nS200\nX2").merged == 0


def test_program_and_smoothed_chains_stay_inside_their_memory():
    angles = np.linspace(0, 60, 3000)
    text = "G64 Q0\nF600\n" + "\n".join(
        f"G1 X{30 * math.sin(a):.4f} Y{20 * math.cos(2 * a):.4f} Z{a:.4f}" for a in angles
    )
    program = gcode.read(text + "\nM2\n")
    path = build(program, MILL, continuity=2)
    assert program.moves.nbytes + path.segments.nbytes + path.pool.nbytes <= 400 * len(program.moves)


def test_no_bend_jumps_through_corner_chain_and_arc():
    path = path_of("G64 P0.05\nF600\nG1 X10\nX12 Y0.1\nX14 Y0.4\nX20 Y10\nG2 X30 Y20 I10\nG1 X50 Y50")
    every = np.arange(len(path))
    inner = np.flatnonzero(path.segments["stop"][:-1] == 0)
    before = path.points(every, path.segments["length"], 2)[inner]
    after = path.points(every, np.zeros(len(path)), 2)[inner + 1]
    assert np.abs(before - after).max() < 1e-9 * np.abs(after).max()
