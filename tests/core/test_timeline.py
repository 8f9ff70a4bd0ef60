"""The time line of a chip against the steps that were planned: none lost, none merged, each in its time; braking."""

from __future__ import annotations

import sys
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.link import FULL_RATE, SLICE, SPAN, Executed, executed
from trochia.kernels.ticks import BACKWARDS, SEGMENT, SegmentRun

if TYPE_CHECKING:
    from numpy.typing import NDArray

_spans = sys.modules["steady_spans"]
SLOT, SPAN_TICKS = _spans.SLOT, _spans.SPAN_TICKS
part, span, due_ticks = _spans.part, _spans.span, _spans.due_ticks


def steady(*arguments: Any, **named: Any) -> bytes:
    return b"".join(_spans.steady(*arguments, **named))


def mine(done: Executed, motor: int) -> NDArray[np.int64]:
    return done.pulses["tick"][done.pulses["pins"] >> motor & 1 == 1]


@pytest.mark.parametrize("rate", [3, 250, 7_000, 50_000, 160_000, 200_000])
def test_one_motor_alone_steps_at_its_ticks(rate: int):
    spans = 4 if rate > 100 else 100
    done = executed(steady([rate], spans))
    np.testing.assert_array_equal(mine(done, 0), due_ticks(rate, spans * SPAN_TICKS))


@pytest.mark.parametrize(
    "rates", [[20_000, 20_000], [40_000, 39_000, 41_000], [99_999, 700], [3, 5_000, 44_100, 60, 1]]
)
def test_several_motors_step_in_the_slot_of_their_tick(rates: list[float]):
    done = executed(steady(rates))
    for motor, rate in enumerate(rates):
        np.testing.assert_array_equal(mine(done, motor) // SLOT, due_ticks(rate, 4 * SPAN_TICKS) // SLOT)
    assert not done.crowded


def test_intervals_that_change_at_every_step_go_by_slots_too():
    done = executed(span({0: part(500, 500, 200, stride=1, add=1 << 22)}))
    rows = np.array([(500 * 256, 1 << 22, 0, 199, 1, 0)], SEGMENT)
    planned = 500 + np.concatenate([[0], np.cumsum(SegmentRun().intervals(rows))])
    np.testing.assert_array_equal(mine(done, 0) // SLOT, planned // SLOT)


segments = st.tuples(st.integers(160, 60_000), st.integers(160, 9_000), st.integers(1, 300), st.integers(1, 40),
                     st.booleans(), st.integers(0, 1 << 15))  # fmt: skip


@given(st.lists(st.dictionaries(st.integers(0, 5), segments, max_size=6), min_size=1, max_size=5), st.integers(0, 127))
def test_whatever_is_sent_no_step_is_lost_merged_or_far_from_its_tick(spans: list[dict[int, Any]], odd: int):
    whole, planned, start, position = b"", {m: [] for m in range(6)}, 0, np.zeros(6, int)
    for number, motors in enumerate(spans):
        parts, last = {}, 1
        for motor, (first, interval, count, stride, back, add) in motors.items():
            parts[motor] = part(first, interval, count, stride=stride, add=add, flags=BACKWARDS * back)
            rows = np.array([(interval * 256, add, 0, max(count - 1, 1), stride, 0)], SEGMENT)
            ticks = first + np.concatenate([[0], np.cumsum(SegmentRun().intervals(rows), dtype=np.int64)])[:count]
            planned[motor] += (start + ticks).tolist()
            position[motor] += -count if back else count
            last = max(last, int(ticks[-1]) + 1)
        last += odd
        whole += span(parts, ticks=last, number=number)
        start += last
    done = executed(whole)
    for motor in range(6):
        ticks = mine(done, motor)
        assert len(ticks) == len(planned[motor])
        if len(ticks):
            late = ticks - np.array(planned[motor])
            assert late.min() >= -SLOT // 2
            assert late.max() <= 3 * SLOT // 2 + 64  # where a span begins within a slot that has gone
            assert np.diff(ticks, prepend=-SLOT).min() >= 64
    assert done.position.tolist() == position.tolist()


def test_a_motor_faster_than_slots_beside_another_ends_in_an_alarm_with_its_true_place():
    done = executed(steady([170_000, 1_000], stride=1))
    assert done.crowded
    assert done.position[:2].tolist() == [len(mine(done, motor)) for motor in range(2)]


@pytest.mark.parametrize("count", [20, 300])
def test_spans_shorter_than_a_slot_lose_no_step(count: int):
    whole = b"".join(span({0: part(0, 50, 1), 1: part(10, 50, 1)}, ticks=60, number=i) for i in range(count))
    done = executed(whole)
    assert done.crowded == (count == 300)  # it cannot catch up: the chip's alarm
    assert [len(mine(done, motor)) for motor in range(2)] == done.position[:2].tolist()
    assert done.crowded or done.position[0] == count


def test_directions_are_told_with_the_steps():
    flags = [0, BACKWARDS, BACKWARDS, 0]
    whole = b"".join(span({1: part(5_000, 4_000, 20, flags=flag)}, number=i) for i, flag in enumerate(flags))
    done = executed(whole)
    assert np.repeat([flag * 2 for flag in flags], 20).tolist() == done.pulses["backwards"].tolist()
    assert done.position[1] == 0


@pytest.mark.parametrize("rates", [[1_000], [50_000], [150_000], [30_000, 31_000], [40_000, 39_000, 3]])
@pytest.mark.parametrize("slew", [300, 1_000, 5_000, 40_000])
def test_braking_makes_exactly_the_steps_of_the_stream_it_ran_through(rates: list[float], slew: int):
    done = executed(steady(rates, 24, slew=slew), brake=3)
    slices = -(-FULL_RATE // slew)
    run = sum(max(FULL_RATE - slew * k, 0) // 2 for k in range(1, slices + 1))
    assert done.rate == 0
    assert done.stream == 3 * SLICE + run  # the rate falls by the slew, slice by slice
    for motor, rate in enumerate(rates):
        planned = due_ticks(rate, done.stream)
        assert done.position[motor] == len(planned) == len(mine(done, motor))
    assert done.pulses["tick"][-1] <= (3 + slices) * SLICE + SLOT


@pytest.mark.parametrize("rates", [[1_000], [150_000], [30_000, 31_000]])
def test_in_a_slice_time_is_stretched_evenly(rates: list[float]):
    slew = 700
    done = executed(steady(rates, 24, slew=slew), brake=1)
    stream, starts = SLICE, [(0, 0, FULL_RATE)]
    for k in range(1, FULL_RATE // slew + 1):
        rate = FULL_RATE - slew * k
        starts.append((k * SLICE, stream, rate))
        stream += rate // 2
    for motor, hertz in enumerate(rates):
        planned, made = due_ticks(hertz, done.stream), mine(done, motor)
        real = np.array([begin + (tick - at) * FULL_RATE / rate for tick in planned
                         for begin, at, rate in [max(s for s in starts if s[1] <= tick)]])  # fmt: skip
        slow = SLICE >> 6  # where the rate is low its reciprocal has few bits
        assert np.abs(made - real).max() <= (SLOT // 2 + slow if len(rates) > 1 else slow)


@pytest.mark.parametrize("slew", [200, 1_000, 3_000])
def test_a_queue_that_does_not_end_at_rest_is_stopped_in_within_its_slew(slew: int):
    done = executed(steady([50_000, 700], 30, slew=slew, rest=False), brake=0)
    assert done.rate == 0
    assert 28 * SPAN_TICKS < done.stream <= 30 * SPAN_TICKS + SLICE
    assert done.position[0] == len(due_ticks(50_000, done.stream))
    gaps = np.diff(mine(done, 0))
    assert gaps[:1000].max() <= 3 * SLOT < gaps[-2:].max()


def test_a_slower_slew_to_come_is_minded_and_speed_taken_up_again_behind_it():
    slews = [4_000] * 8 + [150] * 2 + [4_000] * 20
    parts = _spans.steady([20_000], 30, rest=False)
    whole = b""
    for each, slew in zip(parts, slews, strict=True):
        head = np.frombuffer(each[: SPAN.itemsize], SPAN).copy()
        head["slew"] = slew
        whole += head.tobytes() + each[SPAN.itemsize :]
    done = executed(whole, brake=0)
    assert done.rate == 0
    assert done.position[0] == len(due_ticks(20_000, done.stream))


def test_pulses_of_different_slots_keep_apart_also_while_braking():
    ticks = executed(steady([60_000, 61_000], 24, slew=500), brake=2).pulses["tick"]
    assert min(after - before for before, after in pairwise(ticks.tolist())) >= 64


def lights(done: Executed) -> list[tuple[int, int]]:
    return list(zip(done.lights["tick"].tolist(), done.lights["power"].tolist(), strict=True))


pixels = st.lists(st.tuples(st.integers(0, 255), st.integers(0, 255)), max_size=40)


@given(st.lists(st.tuples(st.integers(1, 60_000), st.integers(0, 255), pixels), min_size=1, max_size=5),
       st.lists(st.integers(100, 900), min_size=2, max_size=2))  # fmt: skip
def test_powers_change_at_their_ticks_whatever_the_motors_do(spans: list[tuple[int, int, Any]], rates: list[int]):
    """Pixels beyond a span's end are none; a power that was is no change."""
    whole, wanted, start, now = b"", [], 0, 0
    for number, (ticks, first, light) in enumerate(spans):
        parts = {motor: part(rate, 50 * rate, 1 + ticks // (60 * rate)) for motor, rate in enumerate(rates)}
        whole += span(parts, ticks=ticks, number=number, power=first, pixels=tuple(light))
        at = 0
        for after, power in [(0, first), *light]:
            at += after * SLOT
            if at >= ticks:
                break
            if power != now:
                wanted.append((start + at, power))
            now = power
        start += ticks
    assert lights(executed(whole)) == wanted


def test_powers_keep_to_the_stream_while_it_is_braked():
    """In a slice of rate r a tick of the stream lasts 1 / r of the chip's."""
    step, slew = 80, 2_000
    whole = b"".join(
        span({}, number=i, slew=slew, rest=i == 23, power=i % 2, pixels=tuple((step, i + k & 1) for k in range(1, 12)))
        for i in range(24)
    )
    done, stream, starts = executed(whole, brake=2), 2 * SLICE, [(0, 0, FULL_RATE)]
    for k in range(1, FULL_RATE // slew + 2):
        rate = max(FULL_RATE - slew * k, 0)
        starts.append(((k + 1) * SLICE, stream, rate))
        stream += rate // 2
    at = np.array([i * SPAN_TICKS + k * step * SLOT for i in range(24) for k in range(1, 12)])
    at = at[(at < done.stream)]
    due = [begin + (tick - since) * FULL_RATE / rate for tick in at.tolist()
           for begin, since, rate in [max(s for s in starts if s[1] <= tick and s[2])]]  # fmt: skip
    seen = done.lights["tick"]
    assert len(seen) == len(due)  # the power that was at each span's beginning is none
    assert np.abs(seen - np.array(due)).max() <= SLICE >> 6


@pytest.mark.parametrize("cut", [1, 11, 13, 31, 33])
def test_bytes_that_are_no_spans_are_refused(cut: int):
    with pytest.raises(ValueError, match="no spans"):
        executed(span({0: part(5_000, 4_000, 20)}, pixels=((5, 6),))[:cut])
