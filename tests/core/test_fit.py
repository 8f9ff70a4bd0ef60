"""Step ticks to tick segments and back: what the executor makes of them stays within the tolerance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.ticks import PAUSE, Ramp, SegmentFit, SegmentRun, speed_move

CLOCK = 16_000_000


def back(ticks: np.ndarray, tolerance: float, begin: int = 0) -> tuple[int, float]:
    """Fit, execute, and return how many segments and the greatest deviation of a step."""
    fit = SegmentFit(begin, tolerance=tolerance)
    segments = fit.fit(ticks)
    made = begin + np.cumsum(SegmentRun().intervals(segments), dtype=np.int64)
    still = np.repeat(segments["flags"] & PAUSE, segments["count"]).astype(bool)
    assert made[~still].size == ticks.size
    worst = np.abs(made[~still] - ticks).max()
    assert fit.now // 1 == made[-1]
    assert fit.worst <= worst + 1
    return segments.size, float(worst)


def trapezoid(speed: float, acceleration: float, steps: int) -> np.ndarray:
    ramp = round(2 * CLOCK**2 / acceleration)
    rising = int(speed**2 / (2 * acceleration))
    counts = (rising, steps - 2 * rising, rising)
    return np.cumsum(speed_move(ramp, ramp, counts, round(CLOCK / speed * 256))[0], dtype=np.int64)


def test_a_move_in_few_segments():
    """10,000 steps, 25,000 steps/s, 250,000 steps/s²: within 1 us, a twenty-fifth of what the field allows."""
    count, worst = back(trapezoid(25_000, 250_000, 10_000), 16)
    assert worst <= 17
    assert count <= 44


def test_at_the_fastest_rate():
    count, worst = back(trapezoid(160_000, 2_000_000, 60_000), 8)
    assert worst <= 9
    assert count <= 60


def test_a_coarse_tolerance_takes_fewer():
    ticks = trapezoid(25_000, 250_000, 10_000)
    fine, coarse = back(ticks, 4), back(ticks, 100)
    assert coarse[0] < fine[0]
    assert fine[1] <= 5


@given(st.lists(st.integers(64, 100_000), min_size=1, max_size=300), st.sampled_from([1.0, 16.0, 400.0]))
def test_any_ticks_at_all(gaps: list[int], tolerance: float):
    ticks = np.cumsum(gaps, dtype=np.int64) + 1000
    _, worst = back(ticks, tolerance, 1000)
    assert worst <= tolerance + 1
    made = SegmentFit(1000, tolerance=tolerance)
    assert made.fit(ticks)["count"].sum() == ticks.size


@given(st.integers(10**9, 2**58), st.integers(1, 2000))
def test_ramps_of_any_steepness(per_step: int, steps: int):
    made = Ramp(per_step).up(min(steps, (2**61) // per_step))
    made = made[: np.argmax(made < 64) if (made < 64).any() else made.size]
    ticks = np.cumsum(made, dtype=np.int64)
    if ticks.size:
        assert back(ticks, 16)[1] <= 17


def test_long_waits_are_pauses():
    ticks = np.array([40 * CLOCK, 40 * CLOCK + 1000, 100 * CLOCK])
    assert back(ticks, 16)[1] <= 1


def test_steps_before_their_time_are_refused():
    with pytest.raises(ValueError, match="4 ticks apart"):
        SegmentFit().fit(np.array([100, 103]))
    with pytest.raises(ValueError, match="after those before"):
        SegmentFit(100).fit(np.array([100]))
    with pytest.raises(ValueError, match="at least a tick"):
        SegmentFit(tolerance=0.5)
