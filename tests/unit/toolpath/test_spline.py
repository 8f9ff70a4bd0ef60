"""Splines as moves: the path is the curve, by its own length."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import BPoly

from trochia.errors import PlanningError
from trochia.machine.load import load
from trochia.planner import plan
from trochia.program import MOVE, MoveKind, PathMode, Program, TimeLaw
from trochia.toolpath import SPLINE_ERROR as ERROR
from trochia.toolpath import SegmentKind, build, measure

MILL = load("reference-mill")
CURVES = {
    "arch": [[0, 0, 0], [0, 40, 0], [50, 40, 0], [50, 0, 0]],
    "in space": [[0, 0, 0], [10, 3, 8], [12, 20, -5], [40, 10, 6]],
    "s": [[0, 0, 0], [60, 0, 0], [-20, 30, 0], [40, 30, 0]],
    "loop": [[0, 0, 0], [60, 50, 0], [-60, 50, 0], [0, 0, 0]],
    "uneven speed": [[0, 0, 0], [1, 0, 0], [2, 1, 0], [50, 40, 0]],
    "end at rest": [[0, 0, 0], [0, 0, 0], [20, 10, 0], [30, 0, 0]],
    "small": [[0, 0, 0], [0.02, 0.01, 0], [0.03, 0.03, 0], [0.05, 0, 0]],
}


def program_of(curves, mode=PathMode.EXACT_PATH, tolerance=0.0, **columns):
    splines = np.array(curves, dtype=np.float64)
    moves = np.zeros(len(splines), dtype=MOVE)
    moves["kind"], moves["turns"], moves["line"] = MoveKind.SPLINE, np.arange(len(splines)), np.arange(len(splines)) + 1
    moves["target"][:, :3], moves["rate"], moves["path_mode"] = splines[:, 3], 50.0, mode
    moves["tolerance"][:, 0] = tolerance
    for name, value in columns.items():
        moves[name] = value
    start = np.zeros(9)
    start[:3] = splines[0, 0]
    return Program(name="p", lines=len(splines), start=start, moves=moves, actions=(), splines=splines)


def bezier(points):
    return BPoly(np.array(points, dtype=np.float64)[:, None, :], [0, 1])


def along(path, count):
    """Points of a whole path, evenly by its segments, and how far along they are."""
    length = path.segments["length"]
    rows = np.repeat(np.arange(len(path)), count)
    s = np.tile(np.linspace(0, 1, count), len(path)) * length[rows]
    return path.points(rows, s), s + np.concatenate([[0], np.cumsum(length)[:-1]])[rows]


@pytest.mark.parametrize("name", [name for name in CURVES if name != "end at rest"])
def test_the_path_is_the_curve_at_the_same_way_along_it(name):
    curve = bezier(CURVES[name])
    slope = curve.derivative()
    path = build(program_of([CURVES[name]]), MILL)
    points, s = along(path, 9)
    whole = quad(lambda u: np.linalg.norm(slope(u)), 0, 1, limit=400, epsabs=1e-11)[0]
    assert path.length == pytest.approx(whole, rel=1e-9)
    fine = np.linspace(0, 1, 40001)
    way = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(curve(fine), axis=0), axis=1))])
    expected = curve(np.interp(s, way * whole / way[-1], fine))
    assert np.linalg.norm(points - expected, axis=1).max() < ERROR
    assert list(np.flatnonzero(path.segments["stop"])) == [len(path) - 1]


def test_a_curve_that_starts_with_two_equal_points_is_kept_too():
    curve = bezier(CURVES["end at rest"])
    points, _ = along(build(program_of([CURVES["end at rest"]]), MILL), 9)
    near = curve(np.linspace(0, 1, 20001))
    assert max(np.linalg.norm(near - point, axis=1).min() for point in points[::7]) < 1e-3


@pytest.mark.parametrize("name", ["arch", "in space", "s"])
def test_ends_have_the_curves_direction_and_bend(name):
    path = build(program_of([CURVES[name]]), MILL)
    curve = bezier(CURVES[name])
    for end, row, s in ((0.0, 0, 0.0), (1.0, len(path) - 1, path.segments["length"][-1])):
        first, second = curve.derivative()(end), curve.derivative(2)(end)
        speed = np.linalg.norm(first)
        bend = (second - first * (first @ second) / speed**2) / speed**2
        here = [path.points(np.array([row]), np.array([s]), order)[0] for order in (1, 2)]
        assert here[0] == pytest.approx(first / speed, abs=1e-9)
        assert here[1] == pytest.approx(bend, abs=1e-9)


def test_parts_of_one_curve_join_without_a_stop_and_without_a_blend():
    p = np.array(CURVES["in space"], dtype=np.float64)
    q = (p[1:] + p[:-1]) / 2
    r = (q[1:] + q[:-1]) / 2
    middle = (r[0] + r[1]) / 2
    path = build(program_of([[p[0], q[0], r[0], middle], [middle, r[1], q[2], p[3]]]), MILL, continuity=2)
    assert list(np.flatnonzero(path.segments["stop"])) == [len(path) - 1]
    assert path.length == pytest.approx(build(program_of([p]), MILL).length, rel=1e-8)


def test_a_kink_between_curves_stops_or_is_blended_inside_the_tolerance():
    kinked = [CURVES["arch"], [[50, 0, 0], [60, 10, 0], [70, 10, 0], [80, 0, 0]]]
    assert build(program_of(kinked), MILL).segments["stop"].sum() == 2
    for continuity, tolerance in ((1, 0.05), (2, 0.5)):
        blended = build(program_of(kinked, PathMode.BLEND, tolerance), MILL, continuity=continuity)
        assert blended.segments["stop"].sum() == 1
        points, _ = along(blended, 25)
        assert 1e-3 < np.linalg.norm(points - [50, 0, 0], axis=1).min() <= tolerance


def test_a_kink_that_is_passed_slower_than_a_stop_takes_is_a_stop():
    kinked = [CURVES["arch"], [[50, 0, 0], [60, 10, 0], [70, 10, 0], [80, 0, 0]]]
    times = []
    for mode, tolerance in ((PathMode.BLEND, 0.01), (PathMode.EXACT_PATH, 0.0)):
        program = program_of(kinked, mode, tolerance)
        path = build(program, MILL, continuity=2)
        assert path.segments["stop"].sum() == 2
        times.append(plan(path, MILL, program=program, profile="s-curve").duration)
    assert times[0] == times[1]


def test_inverse_time_is_that_of_the_whole_curve():
    path = build(program_of([CURVES["arch"]], law=TimeLaw.INVERSE, rate=0.5), MILL)
    assert path.segments["speed_limit"] == pytest.approx(np.full(len(path), 0.5 * path.length))


def test_other_axes_go_evenly():
    program = program_of([CURVES["arch"]])
    moves = program.moves.copy()
    moves["target"][0, 3] = 90.0
    turned = Program(name="p", lines=1, start=program.start, moves=moves, actions=(), splines=program.splines)
    path = build(turned, load("rotary-mill"))
    points, s = along(path, 5)
    assert points[:, 3] == pytest.approx(90.0 * s / path.length, abs=1e-9)


def test_a_curve_is_one_move_however_many_pieces_it_has():
    path = build(program_of([CURVES["arch"]]), MILL, blend=False)
    size = measure(path)
    assert set(path.segments["kind"]) == {SegmentKind.CUBIC}
    assert (size.moves, size.feed_moves, size.feed_length) == (1, 1, pytest.approx(path.length))
    assert size.extents[1][:2] == pytest.approx([50, 30], abs=ERROR)  # half-way: 3/4 of the height of the handles


def test_a_curve_that_goes_nowhere_leaves_nothing():
    assert len(build(program_of([[[0, 0, 0]] * 4]), MILL)) == 0


@pytest.mark.parametrize("row", [-1, 1, 2**31 - 1])
def test_a_spline_that_is_not_there_is_refused(row):
    with pytest.raises(ValueError, match="move 0 follows a spline that is not there"):
        build(program_of([CURVES["arch"]], turns=row), MILL)


def test_a_spline_that_leads_elsewhere_is_refused():
    with pytest.raises(ValueError, match="does not lead to its target"):
        build(program_of([CURVES["arch"]], target=[0, 1, 2, 0, 0, 0, 0, 0, 0]), MILL)


def test_a_curve_in_an_axis_the_machine_lacks_is_named_with_its_line():
    with pytest.raises(PlanningError, match="axis Z") as caught:
        build(program_of([[[0, 0, 0], [1, 0, 9], [2, 0, 9], [3, 0, 0]]]), load("xy-table"))
    assert caught.value.source.line == 1


def test_splines_have_four_points_of_three_numbers():
    with pytest.raises(ValueError, match="control points"):
        Program(name="p", lines=0, start=np.zeros(9), moves=np.zeros(0, MOVE), actions=(), splines=np.zeros((1, 3, 3)))


def test_way_by_feed_takes_its_time():
    # between the ends |x'| is 1 but for the spline's error, so ds/dt is the speed along the curve
    path = build(program_of([CURVES["arch"]]), MILL)
    rows = np.repeat(np.arange(len(path)), 7)
    s = np.tile(np.linspace(0, 1, 7), len(path)) * path.segments["length"][rows]
    assert np.linalg.norm(path.points(rows, s, 1), axis=1) == pytest.approx(1.0, abs=1e-4)
    assert math.isclose(path.segments["speed_limit"][0], 50.0)
