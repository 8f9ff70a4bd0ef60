"""Moves given by time: closed forms, the published vectors of each law, and the trajectory made of them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import cumulative_trapezoid

from trochia.errors import LimitError
from trochia.machine.load import load
from trochia.planner import Limits
from trochia.planner.timed import blended, excesses, joined, plan_timed, pvt, ramps, rest, spline1, spline2
from trochia.program import MOVE, Program

MILL = load("reference-mill")


def change_of_slope(pieces, derivative):
    """Greatest jump of a derivative between pieces."""
    starts = pieces.starts[1:]
    return np.abs(pieces.at(starts, derivative) - pieces.at(starts - 1e-12, derivative)).max()


def test_pvt_is_a_cubic_with_its_ends():
    pieces = pvt([0.0], [[100.0], [600.0], [1100.0], [1200.0]], [[1500.0], [3000.0], [1500.0], [0.0]], [0.2] * 4)
    # velocity goes along parabolas: accelerations at both ends and velocities in the middle, as published
    at = pieces.starts
    assert pieces.at(at, 2)[:, 0] == pytest.approx([0.0, 15000.0, 0.0, -15000.0], abs=1e-8)
    assert pieces.at(at + 0.1, 1)[:, 0] == pytest.approx([375.0, 2625.0, 2625.0, 375.0])
    assert pieces.at([0.2, 0.4, 0.6, 0.8])[:, 0] == pytest.approx([100, 600, 1100, 1200])
    assert pieces.at(0.8, 1)[0, 0] == pytest.approx(0.0, abs=1e-9)


def test_a_series_of_pvt_ends_at_rest():
    with pytest.raises(LimitError, match="ends at rest"):
        pvt([0.0], [[1.0]], [[1.0]], [0.1])
    with pytest.raises(LimitError, match="above zero"):
        pvt([0.0], [[1.0]], [[0.0]], [0.0])


def test_one_move_with_rounded_ramps():
    # TA 125, TS 35, TM 1000 ms to X 10, Y 20
    pieces = blended(ramps([0.0, 0.0], [[10.0, 20.0]], tm=1.0, ta=0.125, ts=0.035))
    assert pieces.duration == pytest.approx(1.125)
    assert pieces.at(0.5, 1)[0] == pytest.approx([10.0, 20.0])
    peaks = pieces.peaks(np.eye(2)).max(axis=1)
    assert peaks[0] == pytest.approx([10.0, 20.0])
    assert peaks[1] == pytest.approx([10.0 / 0.09, 20.0 / 0.09])  # 111.11, 222.22
    assert peaks[2] == pytest.approx([10.0 / (0.09 * 0.035), 20.0 / (0.09 * 0.035)])  # 3174.6
    assert pieces.at(pieces.duration)[0] == pytest.approx([10.0, 20.0])
    assert change_of_slope(pieces, 2) < 1e-6


def test_one_move_without_rounding_is_a_trapezoid():
    pieces = blended(ramps([0.0, 0.0], [[20.0, 10.0]], tm=1.0, ta=0.5, ts=0.0))
    assert pieces.duration == pytest.approx(1.5)
    assert pieces.durations == pytest.approx([0.5, 0.5, 0.5])
    assert pieces.at(0.75, 1)[0] == pytest.approx([20.0, 10.0])
    assert pieces.peaks(np.eye(2)).max(axis=1)[1] == pytest.approx([40.0, 20.0])


def test_a_corner_is_cut_by_the_formula():
    ta, ts, v = 0.1, 0.03, 100.0
    pieces = blended(ramps([0.0, 0.0], [[20.0, 0.0], [20.0, 20.0]], tm=0.2, ta=ta, ts=ts))
    corner = pieces.at(ta / 2 + 0.2)[0]  # passed at the instant of the corner
    cut = np.hypot(v, v) * ((ta - ts) / 8 + ts**2 / (24 * (ta - ts)))
    assert np.linalg.norm(corner - [20.0, 0.0]) == pytest.approx(cut)
    assert pieces.duration == pytest.approx(0.5)


@given(st.data())
def test_blending_is_smoothing_the_even_velocities(data):
    """With one TA and TS it is the moves' even velocities under the kernel box(TA - TS) * box(TS)."""
    count = data.draw(st.integers(1, 5))
    ends = np.array(data.draw(st.lists(st.floats(-50, 50), min_size=count, max_size=count)))[:, None]
    tm = np.array(data.draw(st.lists(st.floats(0.1, 0.4), min_size=count, max_size=count)))
    ta, ts = 0.1, data.draw(st.sampled_from([0.0, 0.02, 0.05]))
    pieces = blended(ramps([0.0], ends, tm=tm, ta=ta, ts=ts))
    assert pieces.duration == pytest.approx(tm.sum() + ta)
    dt = 1e-4
    t = np.arange(0.0, pieces.duration + dt, dt)
    edges = np.concatenate([[0.0], np.cumsum(tm)])
    position = np.interp(t, edges, np.concatenate([[0.0], ends[:, 0]]))  # of the even velocities, box by box averaged
    for width in (ta - ts, ts):
        if width:
            area = cumulative_trapezoid(position, t, initial=0.0)
            position = (area - np.interp(t - width, t, area)) / width
    assert pieces.at(t)[:, 0] == pytest.approx(position, abs=2e-3 * (1 + np.abs(ends).max()))


def test_ta_is_at_least_twice_ts_and_tm_at_least_ta():
    moves = ramps([0.0], [[1.0]], tm=0.01, ta=0.05, ts=0.04)
    assert moves.ramps == pytest.approx([0.08, 0.08])
    assert moves.times == pytest.approx([0.08])
    with pytest.raises(LimitError, match="both 0"):
        ramps([0.0], [[1.0]], tm=1.0, ta=0.0)


def test_limits_stretch_tm_and_ta():
    moves = ramps([0.0], [[100.0]], tm=0.5, ta=0.1, ts=0.02, velocity=[100.0], acceleration=[500.0])
    assert moves.times == pytest.approx([1.0])
    assert moves.ramps == pytest.approx([0.22, 0.22])  # |v| / (TA - TS) = 500
    assert moves.accelerations.max() == pytest.approx(500.0)


def test_a_ramp_never_reaches_into_the_one_before():
    moves = ramps([0.0], [[10.0], [0.0], [10.0]], tm=0.1, ta=0.02, acceleration=[1000.0])
    assert (moves.ramps[1:] / 2 + moves.ramps[:-1] / 2 <= moves.times + 1e-12).all()
    pieces = blended(moves)
    limits = dataclasses.replace(Limits.of(MILL), names=("axis X",), matrix=np.eye(1), velocity=np.array([1e3]),
                                 acceleration=np.array([1000.0]), jerk=np.array([np.inf]))  # fmt: skip
    (found,) = excesses(pieces, limits)
    assert (found.limit, found.kind) == ("axis X", "acceleration")
    assert found.value == pytest.approx(moves.accelerations.max())
    assert "of 1000" in str(found)


@given(st.lists(st.tuples(st.floats(-20, 20), st.floats(0.02, 0.5), st.floats(0.01, 0.4), st.floats(0, 0.1)),
                min_size=1, max_size=6))  # fmt: skip
def test_any_times_make_a_motion_without_a_jump(moves):
    ends, tm, ta, ts = (np.array(column) for column in zip(*moves, strict=True))
    pieces = blended(ramps([0.0], ends[:, None], tm=tm, ta=ta, ts=ts, velocity=[200.0], acceleration=[2000.0]))
    scale = 1.0 + np.abs(ends).max()
    assert change_of_slope(pieces, 0) < 1e-6 * scale
    assert change_of_slope(pieces, 1) < 1e-4 * scale
    assert pieces.at(pieces.duration)[0, 0] == pytest.approx(ends[-1], abs=1e-9 * scale)
    assert pieces.peaks(np.eye(1)).max(axis=1)[0, 0] <= 200.0 * (1 + 1e-9)


def test_an_even_spline_by_its_published_knots():
    pieces = spline1([0.0, 0.0], [[1.0, -1.0], [2.0, -2.0], [3.0, -3.0]], 1.0)
    knots = pieces.at(np.arange(6.0))
    assert pieces.duration == 5.0
    assert knots[:, 0] == pytest.approx([0, 1 / 6, 1, 2, 17 / 6, 3])
    assert knots[:, 1] == pytest.approx(-knots[:, 0])
    assert pieces.at(np.arange(6.0), 1)[:, 0] == pytest.approx([0, 0.5, 1, 1, 0.5, 0])
    assert change_of_slope(pieces, 2) < 1e-9


@given(st.lists(st.tuples(st.floats(-20, 20), st.floats(0.01, 2.0)), min_size=1, max_size=8))
def test_an_uneven_spline_is_smooth_and_ends_on_its_points_at_rest(points):
    values, slices = (np.array(column) for column in zip(*points, strict=True))
    pieces = spline2([5.0], values[:, None], slices)
    ends = [0.0, pieces.duration]
    assert pieces.at(ends)[:, 0] == pytest.approx([5.0, values[-1]], abs=1e-8)
    for derivative, least in ((1, 1e-6), (2, 1e-4)):
        size = 1.0 + np.abs(pieces.peaks(np.eye(1))[derivative - 1]).max()
        assert np.abs(pieces.at(ends, derivative)).max() < least * size
        assert change_of_slope(pieces, derivative) < least * size
    # inside what the points span: a B-spline is a mean of them
    inside = pieces.at(np.linspace(0, pieces.duration, 301))
    assert inside.min() >= min(values.min(), 5.0) - 1e-8
    assert inside.max() <= max(values.max(), 5.0) + 1e-8


def test_slices_are_bounded():
    with pytest.raises(LimitError, match="three slices"):
        spline2([0.0], [[1.0], [2.0], [3.0]], [3000.0, 3000.0, 3000.0])
    with pytest.raises(LimitError, match="above zero"):
        spline1([0.0], [[1.0]], 0.0)


def program(count):
    moves = np.zeros(count, dtype=MOVE)
    moves["line"] = np.arange(count) + 11
    return Program(name="timed", lines=count, start=np.zeros(9), moves=moves, actions=())


def test_a_trajectory_tells_what_the_pieces_are():
    first = blended(ramps([0.0, 0.0, 0.0], [[20.0, 0.0, 0.0], [20.0, 20.0, 1.0]], tm=0.4, ta=0.1, ts=0.03))
    still = rest([20.0, 20.0, 1.0], 0.25, 1)
    last = spline1([20.0, 20.0, 1.0], [[10.0, 10.0, 0.0]], 0.2)
    last = dataclasses.replace(last, moves=last.moves + 2)
    pieces = joined([first, still, last])
    trajectory = plan_timed(pieces, program(3), MILL)
    t = np.linspace(0.0, trajectory.duration, 777)
    for derivative, ask in enumerate((trajectory.position, trajectory.velocity, trajectory.acceleration)):
        assert ask(t) == pytest.approx(pieces.at(t, derivative), abs=1e-9 * 10**derivative)
    assert trajectory.times["dwell"] == pytest.approx(0.25)
    assert sum(trajectory.times.values()) == pytest.approx(trajectory.duration)
    assert trajectory.move_times.sum() == pytest.approx(trajectory.times["motion"])
    assert trajectory.line_at([0.1, 0.8, 1.4]).tolist() == [11, 12, 13]
    assert trajectory.peaks["X"]["velocity"] == pytest.approx(50.0)
    assert sum(len(block) for block in trajectory.blocks(5)) == len(pieces.durations)
    ends = [-1.0, trajectory.duration + 1.0]
    assert trajectory.position(ends) == pytest.approx(np.array([[0, 0, 0], [10, 10, 0]]), abs=1e-9)
    assert not excesses(pieces, Limits.of(dataclasses.replace(MILL, axes=tuple(
        dataclasses.replace(axis, acceleration=1e4, jerk=1e6) for axis in MILL.axes))))  # fmt: skip


def test_parts_meet():
    with pytest.raises(LimitError, match="gap"):
        joined([rest([0.0], 1.0), rest([1.0], 1.0)])
