"""The path's C against plain statements of the same curves: complex exponentials, polynomials, finite sums."""

from __future__ import annotations

import cmath
import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from trochia.kernels import path as kernel
from trochia.kernels.layout import MOVE, PHASE, SEGMENT
from trochia.program import MoveKind

small = st.floats(-100, 100)


def sampled(kind, coefficients, n, s, **columns):
    """The first four derivatives by s of one segment, made by C: a state of ds/dt = 1 is the chain rule's identity."""
    segments = np.zeros(1, dtype=SEGMENT)
    segments["kind"], segments["length"] = kind, 1.0
    for name, value in columns.items():
        segments[name] = value
    states = np.zeros(1, dtype=PHASE)
    states["s"], states["v"] = s, 1.0
    pool = np.array(coefficients, dtype=np.float64)
    return [kernel.sample(segments, pool, n, states, order)[0] for order in range(4)]


@given(st.lists(small, min_size=4, max_size=4), st.floats(0, 1))
def test_lines(c, s):
    got = sampled(0, c, 2, s)
    assert got[0] == pytest.approx([c[0] + c[2] * s, c[1] + c[3] * s])
    assert [list(x) for x in got[1:]] == [c[2:], [0, 0], [0, 0]]


@given(st.lists(small, min_size=8, max_size=8), st.floats(0, 1))
def test_cubics(c, s):
    got = sampled(2, c, 2, s)
    for axis in range(2):
        curve = Polynomial(c[axis::2])
        for order in range(4):
            assert got[order][axis] == pytest.approx(curve.deriv(order)(s) if order else curve(s), abs=1e-9)


def arc_taylor(c, s):
    """Derivatives of r exp(i phi) by Leibniz' rule on r and on exp(i phi)."""
    rate, curve = c["rate"], c["curve"]
    r, dr = c["r"] + c["dr"] * s, c["dr"]
    phi = c["angle"] + rate * s + curve * s * s
    d1, d2 = 1j * (rate + 2 * curve * s), 1j * 2 * curve
    e = cmath.exp(1j * phi)
    turn = [e, e * d1, e * (d1**2 + d2), e * (d1**3 + 3 * d1 * d2)]
    return [turn[0] * r] + [turn[k] * r + k * turn[k - 1] * dr for k in (1, 2, 3)]


@given(st.fixed_dictionaries({
    "r": st.floats(0.1, 50), "dr": st.floats(-0.1, 0.1), "angle": st.floats(-7, 7), "rate": st.floats(-3, 3),
    "curve": st.floats(-0.1, 0.1)}), st.floats(0, 1))  # fmt: skip
def test_arcs_and_spirals(c, s):
    pool = [5.0, -3.0, c["r"], c["angle"], c["rate"], c["dr"], 1.0, 0.0, 0.0, 0.25, 0.0, 0.0, c["curve"]]
    got = sampled(1, pool, 3, s, first=1, second=2)
    for order, z in enumerate(arc_taylor(c, s)):
        assert got[order][1] == pytest.approx(z.real + (5.0 if order == 0 else 0.0), abs=1e-9)
        assert got[order][2] == pytest.approx(z.imag - (3.0 if order == 0 else 0.0), abs=1e-9)
    assert [x[0] for x in got] == [1 + 0.25 * s, 0.25, 0, 0]


@given(st.floats(0, 200), st.floats(-3000, 3000), st.floats(-1e5, 1e5))
def test_the_chain_rule(v, a, j):
    c = Polynomial([1, 2, -3, 4])
    segments = np.zeros(1, dtype=SEGMENT)
    segments["kind"], segments["length"] = 2, 1.0
    states = np.zeros(1, dtype=PHASE)
    states["s"], states["v"], states["a"], states["j"] = 0.5, v, a, j
    whole = c(Polynomial([0.5, v, a / 2, j / 6]))  # x(s(t)) about t = 0
    for order in range(4):
        got = kernel.sample(segments, c.coef, 1, states, order)[0, 0]
        expected = whole.coef[order] * math.factorial(order) if order < len(whole.coef) else 0.0
        assert got == pytest.approx(expected, rel=1e-9, abs=1e-6)


def moves_of(*rows):
    moves = np.zeros(len(rows), dtype=MOVE)
    for move, (x, y, mode, tolerance) in zip(moves, rows, strict=True):
        move["kind"], move["rate"], move["target"][:2] = MoveKind.FEED, 10.0, (x, y)
        move["path_mode"], move["tolerance"][0] = mode, tolerance
    return moves


def built(moves, rests=None, columns=(0, 1), tolerance=0.01, **more):
    still = np.zeros(len(moves), dtype=np.uint8) if rests is None else np.array(rests, dtype=np.uint8)
    return kernel.build(moves, still, start=np.zeros(9), columns=columns, tolerance=tolerance, **more)


def reference_shares(points, tolerance):
    """What each joint of a chain takes: its wish, or half, or what the other leaves; half at most beside rest."""
    steps = np.diff(np.array([(0.0, 0.0), *points]), axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    unit = steps / lengths[:, None]
    wishes = [4 * tolerance / np.linalg.norm(b - a) for a, b in pairwise(unit)]
    taken, before = [], 0.0
    for k, wish in enumerate(wishes):
        other = wishes[k + 1] if k + 1 < len(wishes) else math.inf
        after = lengths[k + 1] - other if other < lengths[k + 1] / 2 else lengths[k + 1] / 2
        before = min(wish, lengths[k] - before if k else lengths[k] / 2, after)
        taken.append(before)
    return taken


corners = st.lists(st.tuples(st.floats(0.1, 5), st.floats(0.01, 2.5)), min_size=2, max_size=12)


@given(corners, st.floats(1e-4, 1))
def test_chains_of_lines_share_their_lengths(steps, tolerance):
    points, heading, here = [], 0.0, np.zeros(2)
    for length, turn in steps:
        heading += turn
        here = here + length * np.array([math.cos(heading), math.sin(heading)])
        points.append(tuple(here))
    segments, _, _, fault = built(moves_of(*[(x, y, 1, tolerance) for x, y in points]))
    assert fault is None
    blends = segments[segments["kind"] == 2]["length"]
    assert blends == pytest.approx([2 * d for d in reference_shares(points, tolerance)], rel=1e-6)


@pytest.mark.parametrize(
    ("before", "after", "stop"), [(1, 1, 0), (1, 2, 1), (2, 1, 1), (3, 1, 1), (1, 3, 1), (0, 0, 0)]
)
def test_the_stricter_of_two_path_modes_holds_at_their_joint(before, after, stop):
    segments, *_ = built(moves_of((1, 0, before, 0.1), (1, 1, after, 0.1)))
    assert segments["stop"][0] == stop
    assert (segments["kind"] == 2).any() == (stop == 0)


def test_a_rest_before_a_move_of_no_length_is_kept_for_the_next():
    moves = moves_of((1, 0, 0, 0), (1, 0, 0, 0), (2, 0, 0, 0))
    segments, *_ = built(moves, rests=[0, 1, 0])
    assert list(segments["stop"]) == [1, 1]
    assert list(segments["move"]) == [0, 2]


def test_a_move_without_speed_is_reported_by_its_row():
    moves = moves_of((1, 0, 0, 0), (2, 0, 0, 0))
    moves["rate"][1] = 0.0
    assert built(moves)[3] == ("feed", 1)


@pytest.mark.parametrize("continuity", [1, 2])  # with curvature, points in line are read as one move
def test_a_letter_that_must_not_move_is_reported_by_its_row(continuity):
    moves = moves_of((1, 0, 1, 0.1), (2, 0, 1, 0.1), (3, 0, 1, 0.1))
    moves["tolerance"][:, 1] = 0.1
    assert built(moves, absent=[5], continuity=continuity)[3] is None
    moves["target"][2, 5] = 90.0
    assert built(moves, absent=[3, 5], continuity=continuity)[3] == ("axis", 2)


def test_one_room_for_many_paths_gives_each_as_it_is():
    room, first, second = kernel.Room(), moves_of((1, 0, 0, 0), (1, 2, 0, 0)), moves_of((3, 0, 0, 0))
    for moves in (first, second, first):
        inside, outside = built(moves, room=room), built(moves)
        assert all((here == there).all() for here, there in zip(inside[:2], outside[:2], strict=True))


@pytest.mark.parametrize("columns", [(), (1, 0), (0, 0), (0, 9), (-1, 0)])
def test_columns_that_cannot_be_are_refused(columns):
    with pytest.raises(ValueError, match="columns"):
        built(moves_of((1, 0, 0, 0)), columns=columns)


def test_a_path_that_points_outside_its_pool_is_refused():
    segments = np.zeros(1, dtype=SEGMENT)
    with pytest.raises(ValueError, match="outside the pool"):
        kernel.check(segments, np.zeros(3), 2)
    segments["kind"] = 7
    with pytest.raises(ValueError, match="unknown kind"):
        kernel.check(segments, np.zeros(30), 2)
    segments["kind"], segments["second"] = 1, 2
    with pytest.raises(ValueError, match="plane"):
        kernel.check(segments, np.zeros(30), 2)
    segments["second"] = 1
    kernel.check(segments, np.zeros(11), 2)


def test_segments_are_appended_with_their_place_and_moves():
    moves = moves_of((1, 0, 0, 0), (1, 2, 0, 0), (3, 0, 0, 0))
    moves["line"], moves["power"] = (5, 6, 9), (0.0, 0.5, 1.0)
    segments, *_ = built(moves)
    count = len(segments)
    rows, lines, power = np.zeros(count, dtype=SEGMENT), np.zeros(count, np.uint32), np.zeros(count, np.float32)
    kernel.append(segments, moves, (rows, lines, power), shift=-3, first=100)
    assert (rows["length"] == segments["length"]).all()
    assert (rows["data"] == segments["data"] - np.uint64(3)).all()
    assert (rows["move"] == segments["move"] + 100).all()
    assert (lines == moves["line"][segments["move"]]).all()
    assert (power == moves["power"][segments["move"]]).all()
    with pytest.raises(ValueError, match="as many"):
        kernel.append(segments, moves, (rows[1:], lines, power), shift=0, first=0)
    with pytest.raises(ValueError, match="not there"):
        kernel.append(segments, moves[:1], (rows, lines, power), shift=0, first=0)
