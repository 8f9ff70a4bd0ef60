"""Paths against plane geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.errors import LimitError, PlanningError
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.program import MOVE
from trochia.toolpath import SegmentKind, build

MILL = load("reference-mill")
ROTARY = load("rotary-mill")


def read(text):
    return gcode.read(text if isinstance(text, bytes) else text + "\nM2\n")


def path_of(text, machine=MILL, **options):
    return build(read(text), machine, **options)


def end_of(path, row=-1):
    row %= len(path)
    return path.points(np.array([row]), path.segments["length"][[row]])[0]


def test_a_line_is_one_segment_of_its_length():
    path = path_of("G1 X3 Y4 F600")
    (segment,) = path.segments
    assert segment["kind"] == SegmentKind.LINE
    assert segment["length"] == 5.0
    assert segment["speed_limit"] == 10.0
    assert segment["stop"] == 1


def test_moves_of_zero_length_leave_nothing():
    assert len(path_of("G1 X0 F600\nX0 Y0\nG0 Z0")) == 0


def test_a_rapid_has_no_speed_of_its_own():
    assert path_of("G0 X1").segments["speed_limit"][0] == math.inf


def test_a_half_circle_is_exact():
    path = path_of("G61\nG3 X0 Y20 I0 J10 F600")
    assert path.segments["length"] == pytest.approx([10 * math.pi], rel=1e-14)
    assert path.extents() == pytest.approx(np.array([[0, 0, 0], [10, 20, 0]]), abs=1e-13)
    assert path.points(np.array([0]), np.array([5 * math.pi]))[0] == pytest.approx([10, 10, 0], abs=1e-13)


@pytest.mark.parametrize(("turns", "word"), [(1, ""), (3, "P3")])
def test_whole_turns(turns, word):
    path = path_of(f"G2 X0 Y0 I-20 J0 {word} F600")
    assert path.length == pytest.approx(turns * 40 * math.pi, rel=1e-14)
    assert path.extents() == pytest.approx(np.array([[-40, -20, 0], [0, 20, 0]]), abs=1e-12)
    assert end_of(path) == pytest.approx([0, 0, 0], abs=1e-12)


@pytest.mark.parametrize(
    ("text", "end"),
    [
        ("G17 G3 X10 Y10 Z4 I0 J10 F600", (10, 10, 4)),
        ("G18 G3 X10 Z10 Y4 I10 K0 F600", (10, 4, 10)),
        ("G19 G3 Y10 Z10 X4 J0 K10 F600", (4, 10, 10)),
    ],
)
def test_a_helix_climbs_evenly_in_every_plane(text, end):
    path = path_of(text)
    angle = path.pool[4] * path.length
    assert abs(angle) in (pytest.approx(math.pi / 2), pytest.approx(3 * math.pi / 2))
    assert path.length == pytest.approx(math.hypot(10 * angle, 4), rel=1e-13)
    assert end_of(path) == pytest.approx(end, abs=1e-12)


def test_radii_that_differ_make_a_spiral_that_ends_at_its_target():
    path = path_of("G61\nG3 X0 Y20.005 I0 J10 F600")
    assert path.segments["kind"][0] == SegmentKind.ARC
    assert end_of(path) == pytest.approx([0, 20.005, 0], abs=1e-12)
    slope = path.points(np.array([0, 0]), np.array([0.0, path.length]), 1)
    assert np.linalg.norm(slope, axis=1) == pytest.approx([1, 1], abs=1e-14)


def test_exact_path_passes_tangents_and_stops_at_corners():
    path = path_of("G61\nG1 X10 F600\nX20\nG3 X30 Y10 J10\nG1 X0")
    assert list(path.segments["stop"]) == [0, 0, 1, 1]
    assert len(path) == 4


def test_exact_stop_stops_everywhere():
    assert list(path_of("G61.1\nG1 X10 F600\nX20").segments["stop"]) == [1, 1]


@pytest.mark.parametrize("degrees", [1, 30, 90, 150])
def test_a_corner_becomes_the_parabola_that_touches_its_tolerance(degrees):
    angle, tolerance = math.radians(degrees), 0.02
    x, y = 50 + 50 * math.cos(angle), 50 * math.sin(angle)
    path = path_of(f"G64 P{tolerance}\nG1 X50 F600\nX{x:.15f} Y{y:.15f}")
    blend = int(np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)[0])
    d = 4 * tolerance / (2 * math.sin(angle / 2))
    assert path.segments["length"][blend] == pytest.approx(2 * d, rel=1e-9)
    middle = path.points(np.array([blend]), np.array([d]))[0]
    assert np.linalg.norm(middle - [50, 0, 0]) == pytest.approx(tolerance, rel=1e-9)
    bend = path.points(np.array([blend]), np.array([0.3 * d]), 2)[0]
    assert np.linalg.norm(bend) == pytest.approx(2 * math.sin(angle / 2) / (2 * d), rel=1e-9)


def test_fine_chords_take_the_curvature_of_what_they_follow():
    angles = np.radians(np.arange(0, 91, 1.0))
    text = "G64 P0.1\nF600\n" + "\n".join(f"G1 X{20 * math.sin(a)!r} Y{20 - 20 * math.cos(a)!r}" for a in angles[1:])
    path = path_of(text)
    blends = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)
    bend = np.linalg.norm(path.points(blends, np.zeros(len(blends)), 2), axis=1)
    assert len(blends) == 89
    # |T2 - T1| / chord = 2 sin(h) / (2 R sin(h)) = 1 / R; the first and last joint have a chord's free half as well
    assert bend[1:-1] == pytest.approx(np.full(87, 1 / 20), rel=1e-6)


def test_a_joint_may_take_what_its_neighbour_leaves():
    # tangent on the far side: nothing is wanted there, so the corner gets all of the short line
    path = path_of("G64 P1\nG1 X50 F600\nX50 Y1\nX50 Y50")
    blend = path.segments[path.segments["kind"] == SegmentKind.CUBIC][0]
    assert blend["length"] == pytest.approx(2.0, rel=1e-12)


def test_no_tolerance_word_means_the_machines():
    default, same = path_of("G64\nG1 X10 F600\nY10"), path_of("G64 P0.01\nG1 X10 F600\nY10")
    assert np.array_equal(default.pool, same.pool)
    assert MILL.path_tolerance == 0.01


def test_turning_back_stops():
    path = path_of("G64 P1\nG1 X10 F600\nX0")
    assert list(path.segments["stop"]) == [1, 1]


def test_an_action_between_two_moves_stops():
    path = path_of("G64 P1\nG1 X10 F600\nM8\nX20")
    assert list(path.segments["stop"]) == [1, 1]


def test_each_side_of_a_blend_keeps_its_feed():
    path = path_of("G64 P1\nG1 X10 F600\nY10 F60")
    cubics = path.segments[path.segments["kind"] == SegmentKind.CUBIC]
    assert list(cubics["speed_limit"]) == [10.0, 1.0]
    assert list(cubics["move"]) == [0, 1]


def test_nearly_tangent_arcs_keep_their_curvature():
    # a quarter of radius 3 entered 1e-4 rad off, as output rounded to four decimals has it
    error = 1e-4
    x = 10 + 3 * math.sin(error)
    path = path_of(f"G64 P0.01\nG1 X10 F600\nG3 X{x + 3:.9f} Y{3:.9f} I{x - 10:.9f} J{3 * math.cos(error):.9f}")
    rows = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)
    assert len(rows) == 1
    ends = [path.points(rows, s, 2) for s in (np.zeros(1), path.segments["length"][rows])]
    assert max(np.linalg.norm(e) for e in ends) < 1.02 / 3


def test_feed_by_inverse_time_and_by_revolution():
    path = path_of("G61\nG93 G1 X10 F30\nG94 F60\nS1200 M3\nG95 G1 X20 F0.1\nM2")
    assert path.segments["speed_limit"] == pytest.approx([5.0, 2.0])


def test_rotary_moves_are_measured_in_degrees():
    path = path_of("G61\nG1 A90 F600\nX1 A180", ROTARY)
    assert path.segments["length"] == pytest.approx([90.0, 1.0])


def test_an_axis_the_machine_lacks_is_named_with_its_line():
    with pytest.raises(PlanningError, match="axis A") as caught:
        path_of("G1 X1 F600\nA10")
    assert caught.value.source.line == 2


def test_a_plane_the_machine_lacks_is_named():
    with pytest.raises(PlanningError, match="axis Z"):
        path_of("G18 G2 X0 Z0 I5 F600", load("xy-table"))


def test_a_feed_without_speed_is_named_with_its_line():
    program = read("G1 X1 F600\nX2")
    moves = program.moves.astype(MOVE)
    moves["rate"][1] = 0.0
    broken = type(program)(name="p", lines=2, start=program.start.copy(), moves=moves, actions=())
    with pytest.raises(LimitError, match="no feed") as caught:
        build(broken, MILL)
    assert caught.value.source.line == 2


def test_a_feed_per_revolution_needs_the_spindle():
    with pytest.raises(LimitError, match="turning spindle"):
        path_of("S1000\nG95 G1 X1 F0.1")


def test_program_and_path_stay_inside_their_memory():
    angles = np.linspace(0, 60, 3000)
    text = "F600\n" + "\n".join(f"G1 X{30 * math.sin(a):.4f} Y{20 * math.cos(2 * a):.4f} Z{a:.4f}" for a in angles)
    program = read(text)
    path = build(program, MILL)
    assert program.moves.nbytes + path.segments.nbytes + path.pool.nbytes <= 400 * len(program.moves)


def test_a_turning_axis_keeps_the_tolerance_in_degrees():
    path = path_of("G64 P0.02\nG1 X10 F600\nX20 A30\nA60", ROTARY)
    exact = path_of("G64 P0.02\nG1 X10 F600\nX20 A30\nA60", ROTARY, blend=False)
    corners = exact.points(np.array([1, 2]), np.zeros(2))
    blends = np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC)
    middles = path.points(blends, path.segments["length"][blends] / 2)
    apart = middles - corners
    assert np.linalg.norm(apart[:, :3], axis=1).max() <= 0.02 * (1 + 1e-9)
    # whichever of the two is nearer to its bound touches it
    assert np.maximum(np.linalg.norm(apart[:, :3], axis=1), np.abs(apart[:, 3])) == pytest.approx([0.02, 0.02])
