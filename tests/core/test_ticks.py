"""Ramps, moves and tick segments: the core's integers against plain statements of the same laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.ticks import SEGMENT, STATES, Ramp, SegmentRun, speed_move

if TYPE_CHECKING:
    from types import ModuleType


@given(st.integers(1, 2**60), st.integers(0, 2**61), st.integers(0, 300))
def test_ramp_is_the_nearest_root(reference: ModuleType, per_step: int, square: int, steps: int):
    steps = min(steps, (2**62 - 1 - square) // per_step)
    made = Ramp(per_step, square)
    assert made.up(steps).tolist() == reference.ramp(per_step, square, steps)
    assert made.down(steps).tolist() == reference.ramp(per_step, square + steps * per_step, -steps)


def test_ramp_over_millions_of_steps_is_exact_to_the_tick():
    """3000 steps/s² on a 16 MHz clock: step k falls at f √(2k/a), from the first to the two-millionth."""
    per_step = round(2 * 16e6**2 / 3000)
    steps = 2_000_000
    ticks = np.cumsum(Ramp(per_step).up(steps), dtype=np.int64)
    exact = 16e6 * np.sqrt(2 * np.arange(1, steps + 1) / 3000)
    assert np.abs(ticks - exact).max() < 0.501


def test_braking_is_the_mirror_of_speeding_up():
    made = Ramp(1_706_666_667)
    up = made.up(100_000)
    assert np.array_equal(made.down(100_000), up[::-1])


counts = st.tuples(*[st.integers(0, 200)] * 3)


@given(st.integers(1, 2**50), st.integers(1, 2**50), counts, st.integers(256, 2**32 - 1))
def test_a_move_up_along_and_down(reference: ModuleType, up: int, down: int, steps: tuple[int, int, int], at: int):
    intervals, states = speed_move(up, down, steps, at)
    expected = reference.speed_move(up, down, steps, at)
    ends = next((i for i, interval in enumerate(expected) if interval == 0), len(expected))
    assert intervals.tolist() == expected[:ends]  # a step in no time at all ends a move
    names = [STATES["ACCEL"]] * steps[0] + [STATES["RUN"]] * steps[1] + [STATES["DECEL"]] * steps[2]
    assert states.tolist() == names[:ends]


rows = st.tuples(st.integers(0, 2**32 - 1), st.integers(-(2**31), 2**31 - 1), st.integers(-(2**31), 2**31 - 1),
                 st.integers(1, 40), st.integers(1, 255), st.sampled_from([0, 1, 2, 3, 4, 5, 8, 9]))  # fmt: skip


@given(st.lists(rows, min_size=1, max_size=6))
def test_segments_are_the_sum_of_their_differences(reference: ModuleType, segments: list[tuple[int, ...]]):
    run = SegmentRun()
    assert run.intervals(np.array(segments, SEGMENT)).tolist() == reference.segments(segments)


def test_a_segment_loses_no_fraction_of_a_tick():
    """A third of a tick more than a hundred, for a million steps in two thousand segments: 85/256 each."""
    segments = np.zeros(2000, SEGMENT)
    segments["interval"], segments["count"], segments["stride"] = 100 * 256 + 85, 500, 16
    run = SegmentRun()
    total = int(run.intervals(segments).sum(dtype=np.int64))
    assert total * 256 + run.fraction == (100 * 256 + 85) * 1_000_000


def test_figures_out_of_range_are_refused():
    with pytest.raises(ValueError, match="2\\^60"):
        Ramp(2**60 + 1)
    with pytest.raises(ValueError, match="2\\^31 ticks"):
        Ramp(2**40).up(2**22)
    with pytest.raises(ValueError, match="rest"):
        Ramp(2**40).down(1)
    with pytest.raises(ValueError, match="do not fit"):
        speed_move(1, 1, (1, -1, 1), 256)
    with pytest.raises(ValueError, match="stride"):
        SegmentRun().intervals(np.zeros(1, SEGMENT))
