"""Cubics along a curve: the curve itself where it is one, near it and smooth where it is none."""

from __future__ import annotations

from itertools import pairwise
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trochia.geometry.cubics import cubics, lengths
from trochia.geometry.nurbs import Nurbs

NUMBER = st.integers(-20, 20).map(float)
POINTS = st.lists(st.tuples(NUMBER, NUMBER, st.sampled_from([0.5, 1.0, 1.0, 3.0])), min_size=3, max_size=7)
TOLERANCE = 1e-4
QUARTER = Nurbs(np.array([(1.0, 0.0, 1.0), (1.0, 1.0, sqrt(0.5)), (0.0, 1.0, 1.0)]), 3)


def along(control, count=101):
    t = np.linspace(0, 1, count)[:, None]
    p = control
    return (1 - t) ** 3 * p[0] + 3 * (1 - t) ** 2 * t * p[1] + 3 * (1 - t) * t**2 * p[2] + t**3 * p[3]


def test_a_cubic_is_itself():
    points = np.array([(0.0, 0.0, 1.0), (0.0, 5.0, 1.0), (10.0, 5.0, 1.0), (10.0, 0.0, 1.0)])
    curve = Nurbs(points, 4)
    (piece,) = cubics(curve.at, curve.spans, TOLERANCE)
    assert piece == pytest.approx(points[:, :2])


def test_a_quadratic_is_raised():
    curve = Nurbs(np.array([(0.0, 0.0, 1.0), (3.0, 6.0, 1.0), (6.0, 0.0, 1.0)]), 3)
    (piece,) = cubics(curve.at, curve.spans, TOLERANCE)
    assert piece == pytest.approx(np.array([(0, 0), (2, 4), (4, 4), (6, 0)]))


def test_a_quarter_circle_stays_on_its_radius():
    pieces = cubics(QUARTER.at, QUARTER.spans, TOLERANCE)
    assert len(pieces) > 1
    radii = np.hypot(*np.vstack([along(piece) for piece in pieces]).T)
    assert np.abs(radii - 1).max() <= TOLERANCE
    assert lengths(pieces).sum() == pytest.approx(pi / 2, abs=1e-4)


@settings(max_examples=30)
@given(points=POINTS, order=st.integers(3, 5))
def test_cubics_are_near_their_curve_and_join_with_one_tangent(points, order):
    curve = Nurbs(np.array(points), min(order, len(points)))
    pieces = cubics(curve.at, curve.spans, TOLERANCE)
    dense = curve.at(np.linspace(0, curve.spans[-1], 4001))[0]
    for piece in pieces:
        made = along(piece, 21)
        away = np.hypot(*(dense[None] - made[:, None]).transpose(2, 0, 1)).min(axis=1)
        step = np.hypot(*np.diff(dense, axis=0).T).max()
        assert away.max() <= TOLERANCE + step
    for one, other in pairwise(pieces):
        assert one[-1] == pytest.approx(other[0], abs=1e-9)


def test_the_length_of_a_line_is_its_own():
    assert lengths(np.array([[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]])) == pytest.approx([3 * sqrt(2)])


def test_a_curve_of_great_numbers_ends():
    curve = Nurbs(np.array([(0.0, 0.0, 1.0), (1e300, 3.0, 2.0), (5.0, 1e300, 1.0)]), 3)
    assert len(cubics(curve.at, curve.spans, TOLERANCE)) < 5000
