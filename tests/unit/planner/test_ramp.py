"""A ramp gets where it is asked to, whatever the accelerations at its ends are."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.planner.ramp import ramp

SPEEDS, ACCELERATIONS = st.floats(0.0, 200.0), st.floats(-1000.0, 1000.0)


@given(v0=SPEEDS, a0=ACCELERATIONS, v1=SPEEDS, a1=ACCELERATIONS, most_a=st.floats(10.0, 2000.0))
def test_it_ends_in_the_state_that_is_asked_for(v0, a0, v1, a1, most_a):
    pieces = ramp((v0, a0), (v1, a1), most_a, 20_000.0)
    v, a = pieces[-1].end if pieces else (v0, a0)
    assert (v, a) == pytest.approx((v1, a1), abs=1e-7)
    assert all(piece.duration > 0.0 and abs(piece.j) in (0.0, 20_000.0) for piece in pieces)


def test_accelerations_beyond_its_own_at_both_ends_do_not_miss_the_goal():
    pieces = ramp((41.146, -858.48), (23.18, -861.39), 339.4, 8484.9)
    assert pieces[-1].end == pytest.approx((23.18, -861.39), abs=1e-9)
    assert min(piece.end[0] for piece in pieces) > 0.0


def test_without_a_limit_of_jerk_speed_changes_at_once_at_the_limit():
    (piece,) = ramp((10.0, 300.0), (4.0, 0.0), 200.0, math.inf)
    assert (piece.duration, piece.a) == pytest.approx((0.03, -200.0))
