"""Decimation is bounded, loses no peak, and keeps the path where it was."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from trochia.analysis.report.decimate import bucket_extremes, bucket_times, simplify

columns = arrays(np.float64, st.integers(1, 400), elements=st.floats(-1e6, 1e6))


@given(values=columns, limit=st.integers(2, 60))
def test_extremes_survive_and_the_count_is_bounded(values, limit):
    kept = bucket_extremes(values, limit)
    assert len(kept) <= limit or len(kept) == len(values) <= limit
    assert kept.min() == values.min()
    assert kept.max() == values.max()


@given(values=columns, limit=st.integers(2, 60))
def test_times_match_the_values_and_rise(values, limit):
    time = np.cumsum(np.full(len(values), 0.25))
    kept = bucket_times(time, limit)
    assert len(kept) == len(bucket_extremes(values, limit))
    assert kept[0] >= time[0]
    assert kept[-1] <= time[-1]
    assert np.all(np.diff(kept) >= 0)


def test_a_short_column_comes_back_whole():
    values = np.array([3.0, 1.0, 2.0])
    assert bucket_extremes(values, 4) is values


def test_values_come_in_the_order_they_occurred():
    falling = bucket_extremes(np.arange(10.0)[::-1], 2)
    assert falling.tolist() == [9.0, 0.0]


@given(
    features=arrays(np.float64, st.tuples(st.integers(0, 300), st.just(2)), elements=st.floats(-100, 100)),
    limit=st.integers(8, 50),
)
def test_simplify_keeps_ends_and_extremes_within_its_limit(features, limit):
    kept = simplify(np.arange(len(features), dtype=float), features, limit)
    assert len(kept) <= limit
    assert np.all(np.diff(kept) > 0)
    if len(features):
        assert kept[0] == 0
        assert kept[-1] == len(features) - 1
        np.testing.assert_array_equal(features[kept].min(axis=0), features.min(axis=0))
        np.testing.assert_array_equal(features[kept].max(axis=0), features.max(axis=0))


def test_simplify_keeps_every_corner_of_a_saw_and_nothing_else():
    corners = np.array([(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, 1.0), (4.0, 0.0)])
    fine = np.linspace(0, 4, 4001)
    saw = np.column_stack((fine, np.interp(fine, corners[:, 0], corners[:, 1])))
    kept = simplify(fine, saw, 5)
    np.testing.assert_allclose(saw[kept], corners, atol=1e-12)


@pytest.mark.parametrize("limit", [100, 400])
def test_simplify_is_close_to_the_path_at_every_instant(limit):
    time = np.linspace(0, 1, 20_001)
    circle = np.column_stack((np.cos(2 * np.pi * time), np.sin(2 * np.pi * time)))
    kept = simplify(time, circle, limit)
    again = np.column_stack([np.interp(time, time[kept], column[kept]) for column in circle.T])
    sagitta = 1 - np.cos(np.pi / limit)  # of evenly spread chords, the best there is
    assert np.linalg.norm(again - circle, axis=1).max() < 8 * sagitta


def test_a_resting_path_is_thinned_too():
    kept = simplify(np.zeros(1000), np.zeros((1000, 2)), 10)
    assert len(kept) == 10
