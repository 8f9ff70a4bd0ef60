"""Curves against closed forms: Bernstein polynomials, the rational circle, difference quotients."""

from __future__ import annotations

from math import comb, sqrt

import numpy as np
import pytest

from trochia.geometry.nurbs import Nurbs

LONG = np.array([[0, 0, 1], [1, 1, 1], [2, -1, 1], [3, 0, 1], [5, 2, 2], [4, 4, 1]], dtype=float)


def test_as_many_points_as_the_order_make_a_bezier_curve():
    points = np.array([[0, 0, 1], [1, 3, 1], [4, 2, 1], [5, -1, 1]], dtype=float)
    u = np.linspace(0, 1, 17)
    bernstein = np.stack([comb(3, k) * u**k * (1 - u) ** (3 - k) for k in range(4)], axis=1)
    assert np.allclose(Nurbs(points, 4).at(u)[0], bernstein @ points[:, :2], atol=1e-14)


def test_weights_make_a_circle():
    quarter = Nurbs(np.array([[1, 0, 1], [1, 1, sqrt(0.5)], [0, 1, 1]]), 3)
    points, slopes = quarter.at(np.linspace(0, 1, 33))
    assert np.allclose(np.hypot(*points.T), 1.0, atol=1e-14)
    assert np.allclose((points * slopes).sum(axis=1), 0.0, atol=1e-14)


@pytest.mark.parametrize("order", [2, 3, 4, 6])
def test_slopes_are_those_of_the_points(order):
    curve = Nurbs(LONG, order)
    u = np.linspace(0, curve.spans[-1], 41)[1:-1] + 1e-3
    before, after = curve.at(u - 1e-6)[0], curve.at(u + 1e-6)[0]
    assert np.allclose(curve.at(u)[1], (after - before) / 2e-6, atol=1e-4)


@pytest.mark.parametrize("order", [2, 3, 4, 6])
def test_a_curve_begins_and_ends_at_its_outer_points(order):
    curve = Nurbs(LONG, order)
    assert len(curve.spans) == len(LONG) - order + 2
    assert np.allclose(curve.at([curve.spans[0], curve.spans[-1]])[0], LONG[[0, -1], :2])


@pytest.mark.parametrize("order", [1, 7])
def test_an_order_that_does_not_fit_is_refused(order):
    with pytest.raises(ValueError, match="order"):
        Nurbs(LONG, order)


def test_a_weight_of_nothing_is_refused():
    with pytest.raises(ValueError, match="weight"):
        Nurbs(LONG * [1, 1, 0], 3)
