"""Contour distance in C against brute force and against circles, corners and reversals known in closed form."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.contour import contour_distance

PERIOD = 1e-3


def circle(t, radius, omega):
    return radius * np.stack([np.cos(omega * t), np.sin(omega * t)], axis=1)


def brute_force(commanded, actual):
    """Distance from every chord of the whole path, one by one."""
    result = []
    for point in actual:
        nearest = min(np.linalg.norm(point - at) for at in commanded)
        for a, b in pairwise(commanded):
            length = float((b - a) @ (b - a))
            u = np.clip((point - a) @ (b - a) / length, 0, 1) if length else 0.0
            nearest = min(nearest, np.linalg.norm(point - a - u * (b - a)))
        result.append(nearest)
    return np.array(result)


@pytest.mark.parametrize(("radius", "omega"), [(20, 1), (5, 10), (0.5, 40)])
@pytest.mark.parametrize("lag", [0.0004, 0.0123, 0.07])
@pytest.mark.parametrize("outside", [0.0, 0.01, -0.01])
def test_on_a_circle_lag_costs_nothing_and_radius_counts(radius, omega, lag, outside):
    t = np.arange(0, 2, PERIOD)
    distance = contour_distance(circle(t, radius, omega), circle(t - lag, radius + outside, omega))
    settled = distance[round(lag / PERIOD) + 2 :]
    sagitta = radius * (omega * PERIOD) ** 2 / 8
    # the cubic's error falls with the fourth power of the angle between samples, a chord's with the second
    np.testing.assert_allclose(settled, abs(outside), atol=max(1e-9, sagitta * (omega * PERIOD) ** 2))


@given(st.floats(0, 0.4), st.floats(-0.3, 0.3), st.integers(0, 40))
def test_on_a_straight_line_only_the_offset_across_counts(lag, across, rest):
    along = np.concatenate([np.zeros(rest), np.linspace(0, 10, 200), np.full(rest, 10.0)])
    commanded = np.stack([along, 0 * along, 0 * along], axis=1)
    actual = commanded + np.array([-lag, 0.6 * across, 0.8 * across])
    before_start = np.maximum(lag - along, 0)  # where the path begins there is nothing further back
    np.testing.assert_allclose(contour_distance(commanded, actual), np.hypot(across, before_start), atol=1e-9)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.01, 0.05]))
def test_never_less_than_the_nearest_chord_but_by_the_curve_between(seed, error):
    random = np.random.default_rng(seed)
    commanded = np.cumsum(random.uniform(-0.1, 1, (40, 2)), axis=0)  # rises on the whole: passes lie apart
    actual = commanded + random.normal(0, error, commanded.shape)
    chords = brute_force(commanded, actual)
    distance = contour_distance(commanded, actual)
    steps = np.linalg.norm(np.diff(commanded, axis=0), axis=1).max()
    assert (distance <= np.linalg.norm(actual - commanded, axis=1) + 1e-12).all()
    assert np.abs(distance - chords).max() <= steps / 4  # a Hermite cubic bulges at most so far from its chord


def test_lag_round_a_corner_is_no_contour_error():
    out = np.stack([np.linspace(0, 5, 501), np.zeros(501)], axis=1)
    up = np.stack([np.full(501, 5.0), np.linspace(0, 5, 501)], axis=1)
    commanded = np.concatenate([out, up])
    lag = 30
    actual = np.concatenate([np.repeat(commanded[:1], lag, axis=0), commanded[:-lag]])
    # at the corner the cubic rounds a 0.01 mm chord by at most an eighth of it
    assert contour_distance(commanded, actual).max() < 0.01 / 8


def test_lag_over_a_reversal_is_no_contour_error():
    way = np.concatenate([np.linspace(0, 5, 501), np.linspace(5, 0, 501)])
    commanded = np.stack([way, 0 * way], axis=1)
    actual = np.concatenate([commanded[:1].repeat(40, axis=0), commanded[:-40]])
    np.testing.assert_allclose(contour_distance(commanded, actual), 0, atol=1e-12)


def test_a_neighbouring_pass_is_not_taken_for_this_one():
    """Two hatch lines 0.1 mm apart, one second apart: being 0.09 mm off the first is not 0.01 mm off the second."""
    x = np.linspace(0, 10, 1001)
    first = np.stack([x, 0 * x], axis=1)
    second = np.stack([x[::-1], 0 * x + 0.1], axis=1)
    commanded = np.concatenate([first, second])
    actual = np.concatenate([first + np.array([0, 0.09]), second])
    distance = contour_distance(commanded, actual)
    np.testing.assert_allclose(distance[:900], 0.09, atol=1e-9)


def test_long_lag_in_slow_motion_is_followed_down_the_path():
    way = np.arange(20_000) * 1e-5  # 0.01 mm/s at 1 kHz: 0.05 mm of lag is 5000 samples
    commanded = np.stack([way, 0 * way], axis=1)
    actual = np.maximum(commanded - np.array([0.05, 0]), 0)
    np.testing.assert_allclose(contour_distance(commanded, actual), 0, atol=1e-12)


@pytest.mark.parametrize("samples", [0, 1, 2, 5])
def test_few_samples_and_no_motion(samples):
    still = np.ones((samples, 3))
    np.testing.assert_allclose(contour_distance(still, still + np.array([0, 3, 4])), 5.0)


def test_bad_arrays_are_refused():
    with pytest.raises(ValueError, match="one shape"):
        contour_distance(np.zeros((3, 2)), np.zeros((4, 2)))
    with pytest.raises(ValueError, match="finite"):
        contour_distance(np.zeros((3, 2)), np.full((3, 2), np.nan))
