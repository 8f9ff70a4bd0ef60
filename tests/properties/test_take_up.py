"""Making up backlash: however reversals follow each other, it keeps to what the planner has kept free for it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from trochia.machine.crossing import TakeUp

B, T = 0.05, 0.08
gaps = st.lists(st.floats(0.0005, 0.2), min_size=1, max_size=30)


def turned(gaps):
    """Return a take-up whose one joint has turned after each of these times."""
    made = TakeUp(np.array([B]), np.array([T]))
    times = np.concatenate([[0.0], np.cumsum(gaps)])
    for k, (begin, end) in enumerate(pairwise(times.tolist())):
        sign = (-1.0) ** k
        made.see(np.array([begin, 0.5 * (begin + end), end]), np.array([[0.0], [sign], [0.0]]))
    return made, times


@given(gaps)
def test_reversals_in_any_order_keep_the_bounds(gaps):
    made, times = turned(gaps)
    t = np.linspace(-0.01, times[-1] + T + 0.01, 8001)
    h = t[1] - t[0]
    offset = made.offset(t)[:, 0]
    rate = np.diff(offset) / h
    steep = np.diff(rate) / h
    assert np.abs(offset).max() <= 0.5 * B * (1 + 1e-9)
    assert np.abs(rate).max() <= 1.875 * B / T * (1 + 1e-6)
    assert np.abs(steep).max() <= 2 * 5.7736 * B / T**2 * (1 + 1e-6)
    if h < T / 200:
        assert np.abs(np.diff(steep)).max() / h <= 3 * 60.0 * B / T**3 * (1 + 1e-6)
    mean = (offset[2:] - offset[:-2]) / (2 * h)
    assert np.abs(made.rate(t)[1:-1, 0] - mean).max() <= 180.0 * B / T**3 * h * h
    last = 1.0 if len(gaps) % 2 else -1.0
    assert abs(offset[-1] - 0.5 * B * last) < 1e-12
    assert made.left(times[-1] + T) == 0.0


@given(gaps, st.floats(0.0, 1.0))
def test_what_is_taken_back_leaves_no_trace(gaps, part):
    whole, times = turned(gaps)
    at = part * times[-1]
    whole.cut(at)
    kept = int(np.searchsorted(times[:-1], at, side="right"))
    short, _ = turned(gaps[:kept]) if kept else (TakeUp(np.array([B]), np.array([T])), None)
    t = np.linspace(0.0, times[-1] + T, 500)
    assert np.allclose(whole.offset(t), short.offset(t), atol=1e-15)


@given(gaps)
def test_what_is_forgotten_was_made_up(gaps):
    whole, times = turned(gaps)
    other, _ = turned(gaps)
    now = times[-1]
    other.forget(now)
    t = np.linspace(now, now + T, 100)
    assert np.allclose(whole.offset(t), other.offset(t), atol=1e-15)
