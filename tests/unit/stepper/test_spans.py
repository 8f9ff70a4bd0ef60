"""Steps as spans: what a chip makes of them, by the firmware's own C, against what was asked."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.link import executed
from trochia.stepper.spans import CLOCK, LEAD, Event, Spans


def events(motor: int, moments: np.ndarray, direction: int, style: int = 1) -> list[Event]:
    return [Event(float(moment), motor, direction, style) for moment in moments]


def played(given: list[Event], chunks: int = 1) -> tuple[dict[int, np.ndarray], list[int]]:
    spans = Spans(given[0].moment)
    size = -(-len(given) // chunks)
    made = [span for first in range(0, len(given), size) for span in spans.made(given[first : first + size])]
    done = executed(b"".join([*made, spans.at_rest()]))
    at = {motor: done.pulses["tick"][done.pulses["pins"] >> motor & 1 == 1] for motor in (0, 1)}
    return at, done.position[:2].tolist()


@given(st.integers(1, 12), st.floats(0.9, 2.3), st.sampled_from([1, -1]))
def test_two_motors_at_once_are_at_their_times(chunks: int, other: float, way: int):
    one, two = np.cumsum(np.full(200, 1 / 400)), np.cumsum(1 / np.sqrt(2 * 900 * other * np.arange(1, 150)))
    given_events = sorted(events(0, one, 1) + events(1, two, way))
    at, position = played(given_events, chunks)
    assert position == [200, 149 * way]
    for motor, wanted in enumerate((one, two)):
        off = at[motor] - (wanted - given_events[0].moment) * CLOCK - LEAD
        assert np.abs(off).max() <= 160 + 64 * 3 + 256  # 10 us of the fit, steps at once, the grid of slots


def test_turning_round_and_a_release_between():
    first = events(0, np.arange(1, 21) / 300, 1)
    back = events(0, 0.08 + np.arange(1, 11) / 300, -1)
    at, position = played([*first, Event(0.07, 0, 0, None), *back])
    assert position == [10, 0]
    assert len(at[0]) == 30


def test_whole_milliseconds_do_not_add_up():
    moments = np.cumsum(np.tile([0.001, 0.002], 2000))
    at, position = played(events(1, moments, 1), 40)
    assert position == [0, 4000]
    assert at[1][-1] - at[1][0] == pytest.approx((moments[-1] - moments[0]) * CLOCK, abs=320)
