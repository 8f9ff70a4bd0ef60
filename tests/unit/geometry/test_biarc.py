"""Arcs along a curve: near it, touching each other, exact where the curve is an arc or a line."""

from __future__ import annotations

from itertools import pairwise
from math import atan2, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.geometry.biarc import biarcs
from trochia.geometry.nurbs import Nurbs

NUMBER = st.integers(-20, 20).map(float)
POINTS = st.lists(st.tuples(NUMBER, NUMBER, st.sampled_from([0.5, 1.0, 1.0, 3.0])), min_size=3, max_size=7)


def dense(pieces, start, count=200):
    """Points along the pieces, and the direction at the ends of each."""
    points, ends = [np.array([start])], []
    for piece in pieces:
        end, share = np.array(piece.end), np.linspace(0, 1, count)[:, None]
        if piece.centre is None:
            way = (end - start) / np.hypot(*(end - start))
            ends.append((way, way))
            points.append(start + share * (end - start))
        else:
            out = np.array(start) - piece.centre
            radius = np.hypot(*out)
            angle = atan2(out[1], out[0]) + piece.sense * share * piece.length / radius
            points.append(piece.centre + radius * np.hstack([np.cos(angle), np.sin(angle)]))
            tangents = piece.sense * np.hstack([-np.sin(angle), np.cos(angle)])
            ends.append((tangents[0], tangents[-1]))
            assert np.allclose(points[-1][-1], end, atol=1e-6)
        start = piece.end
    return np.vstack(points), ends


@given(points=POINTS, order=st.sampled_from([3, 4]))
def test_arcs_stay_near_the_curve(points, order):
    curve = Nurbs(np.array(points), min(order, len(points)))
    pieces = biarcs(curve.at, curve.spans, 1e-3)
    true = curve.at(np.linspace(0, curve.spans[-1], 3000))[0]
    if not pieces:
        assert np.ptp(true, axis=0).max() <= 1e-3
        return
    made, _ = dense(pieces, (float(true[0][0]), float(true[0][1])), 60)
    gap = np.hypot(*np.diff(true, axis=0).T).max() + max(piece.length for piece in pieces) / 59
    for some in np.array_split(true, 30):
        away = np.hypot(some[:, None, 0] - made[:, 0], some[:, None, 1] - made[:, 1]).min(axis=1)
        assert away.max() <= 1e-3 + gap
    assert np.allclose(pieces[-1].end, true[-1], atol=1e-3)


def test_arcs_touch_each_other():
    curve = Nurbs(np.array([[0, 0, 1], [1, 4, 1], [6, -4, 1], [9, 3, 1.0]]), 4)
    pieces = biarcs(curve.at, curve.spans, 1e-3)
    _, ends = dense(pieces, (0.0, 0.0))
    for (_, before), (after, _) in pairwise(ends):
        assert np.allclose(before, after, atol=1e-6)
    true = curve.at(np.linspace(0, 1, 100_000))[0]
    assert sum(piece.length for piece in pieces) == pytest.approx(np.hypot(*np.diff(true, axis=0).T).sum(), abs=1e-4)


def test_a_circle_stays_a_circle():
    quarter = Nurbs(np.array([[1, 0, 1], [1, 1, sqrt(0.5)], [0, 1, 1]]), 3)
    pieces = biarcs(quarter.at, quarter.spans, 1e-3)
    assert sum(piece.length for piece in pieces) == pytest.approx(pi / 2)
    assert all(np.allclose(piece.centre, 0.0, atol=1e-12) and piece.sense == 1 for piece in pieces)


def test_a_line_stays_a_line():
    line = Nurbs(np.array([[0, 0, 1], [1, 1, 1], [3, 3, 1.0]]), 3)
    assert all(piece.centre is None for piece in biarcs(line.at, line.spans, 1e-3))


def test_a_point_is_nothing():
    point = Nurbs(np.ones((3, 3)), 3)
    assert biarcs(point.at, point.spans, 1e-3) == []
