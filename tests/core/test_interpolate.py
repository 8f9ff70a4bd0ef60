"""The shared interpolators' integers: roots, the source's own example, long figures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.interpolate import GREATEST, METHODS, Begun
from trochia.pulses.interpolators.frame import nearest_root, root
from trochia.pulses.interpolators.point import arc as point_arc

X_CLOCK, Y_CLOCK = 4, 8


def test_dda_of_5_and_3_in_8_ticks() -> None:
    """The source's example, X = 5, Y = 3, N = 8: a pulse whenever k/8 of the way reaches the next whole step."""
    pulses = Begun.line(METHODS["dda"], 5, 3).pulses()
    assert pulses.size == 8
    assert (np.flatnonzero(pulses & X_CLOCK) + 1).tolist() == [2, 4, 5, 7, 8]
    assert (np.flatnonzero(pulses & Y_CLOCK) + 1).tolist() == [3, 6, 8]


@given(st.one_of(st.integers(0, 10**6), st.integers(0, 2**62)))
def test_root_is_the_whole_square_root(value: int) -> None:
    assert root(value) == math.isqrt(value)


@given(st.integers(1, 2**30))
def test_nearest_root_rounds(value: int) -> None:
    assert abs(nearest_root(value * value + value) - value) == 0
    assert nearest_root(value * value + value + 1) == value + 1


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("x", "y"), [(1_000_000, -999_999), (-3, 2_000_000), (0, 3_000_000), (0, 0)])
def test_long_lines_lose_nothing(method: str, x: int, y: int) -> None:
    pulses = Begun.line(METHODS[method], x, y).pulses()
    assert np.count_nonzero(pulses & X_CLOCK) == abs(x)
    assert np.count_nonzero(pulses & Y_CLOCK) == abs(y)


@pytest.mark.parametrize("method", METHODS)
def test_a_small_arc_of_a_huge_circle(method: str) -> None:
    """Near the greatest radius nothing overflows: from the X axis up by sixty thousand steps."""
    radius, rise = 2**30 - 2**12, 60_000
    end = math.isqrt(radius * radius - rise * rise)
    pulses = Begun.arc(METHODS[method], (radius, 0), (end, rise), radius * radius, clockwise=False).pulses()
    assert np.count_nonzero(pulses & Y_CLOCK) == rise
    assert np.count_nonzero(pulses & X_CLOCK) == radius - end


def test_timing_run_makes_the_same_pulses() -> None:
    begun = Begun.arc(METHODS["octant"], (0, -50), (0, -50), 2500, clockwise=True)
    assert begun.over(3) == 3 * int(begun.pulses().sum(dtype=np.int64))


def test_bad_figures_are_refused() -> None:
    with pytest.raises(ValueError, match="within"):
        Begun.line(METHODS["dda"], GREATEST + 1, 0)
    with pytest.raises(ValueError, match="no further out"):
        Begun.arc(METHODS["dda"], (0, 10), (11, 0), 108, clockwise=False)
    with pytest.raises(ValueError, match="radius"):
        Begun.arc(METHODS["dda"], (0, 0), (1, 0), 1, clockwise=False)


def test_point_by_point_on_the_smallest_circle() -> None:
    assert list(point_arc(1, 0, 0, 1, 1)) == [(True, False), (False, True)]
