"""The distance beside the path: lag is none of it, another pass at the same place neither."""

from __future__ import annotations

import numpy as np

from trochia.analysis.report.deviation import deviation

TIME = np.arange(0, 1, 0.001)


def line(offset: float, shift: float = 0.0):
    return np.column_stack((100 * (TIME - shift), np.full_like(TIME, offset)))


def test_lag_along_a_straight_line_is_no_deviation():
    found = deviation(line(0), line(0, shift=0.0503), np.arange(100, 1000))
    np.testing.assert_allclose(found, 0, atol=1e-12)


def test_an_offset_comes_back_with_its_direction_whatever_the_lag():
    found = deviation(line(0), line(-0.02, shift=0.0503), np.arange(100, 1000))
    np.testing.assert_allclose(found, np.tile((0.0, -0.02), (900, 1)), atol=1e-12)


def test_a_lead_is_no_deviation_either():
    found = deviation(line(0), line(0, shift=-0.0207), np.arange(0, 900))
    np.testing.assert_allclose(found, 0, atol=1e-12)


def test_a_smaller_circle_deviates_by_the_difference_of_radii():
    angle = 2 * np.pi * TIME
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    late = np.column_stack((np.cos(angle - 0.3), np.sin(angle - 0.3)))
    found = deviation(50 * circle, 49.9 * late, np.arange(100, 1000))
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 0.1, atol=1e-3)


def test_a_pass_next_to_this_one_is_not_mistaken_for_it():
    out, back = line(0), line(0.05)[::-1]
    commanded = np.concatenate((out, back))
    actual = commanded - (0.0, 0.04)
    found = deviation(commanded, actual, np.arange(1100, 1900))
    np.testing.assert_allclose(found, np.tile((0.0, -0.04), (800, 1)), atol=1e-12)
