"""Laws of live motion: whenever it is held, resumed or overridden, it keeps to its path and to every limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels import path as kernel
from trochia.planner import PROFILES, Limits, plan
from trochia.planner.live import LivePlan, lookahead
from trochia.toolpath import build

POINTS = 11
MACHINES = ["mill", "capped", "belts", "rotary"]
PARTS = st.floats(0, 1)
WORDS = st.tuples(st.sampled_from(["hold", "resume", "relight", "feed", "rapid"]), PARTS, PARTS)


@pytest.fixture(scope="module", autouse=True)
def _small():
    """Windows so small that a short program has many of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lookahead, "WINDOW", 8.0)
        yield


def machine_of(motion, name):
    machine = motion.machines[name]
    axes = tuple(replace(axis, jerk=axis.jerk or 20 * axis.acceleration) for axis in machine.axes)
    caps = replace(machine.path, jerk=15_000.0) if name == "capped" else machine.path
    return replace(machine, axes=axes, path=caps)


def sampled(portion):
    """States at evenly spaced instants of every phase, ends included, by the phases' own arithmetic."""
    states = np.repeat(portion.phases, POINTS)
    tau = np.tile(np.linspace(0, 1, POINTS), len(portion.phases)) * states["duration"]
    states["s"] += tau * (states["v"] + tau * (states["a"] / 2 + tau * states["j"] / 6))
    states["v"] += tau * (states["a"] + tau * states["j"] / 2)
    states["a"] += tau * states["j"]
    states["t"] += tau
    return states


def check_limits(limits, portion, jerky):
    rows = (limits.velocity, limits.acceleration, limits.jerk)
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    states = sampled(portion)
    for order in (1, 2, 3) if jerky else (1, 2):
        asked = kernel.sample(portion.segments, portion.pool, len(portion.axes), states, order)
        assert (np.abs(asked @ limits.matrix.T) <= rows[order - 1] * (1 + 1e-9)).all()
        vector = np.linalg.norm(asked[:, : limits.linear], axis=1)
        assert (vector <= caps[order - 1] * (1 + 1e-9)).all()


def check_joints(limits, portions, jerky):
    """Motion goes on without a jump of place and velocity, and with limited jerk of acceleration."""
    last = None
    for portion in portions:
        states = sampled(portion)
        values = [kernel.sample(portion.segments, portion.pool, len(portion.axes), states, order) for order in range(3)]
        if portion.backwards:
            values[1] = -values[1]
        ends = [value.reshape(-1, POINTS, value.shape[1]) for value in values]
        n = len(portion.axes)
        scales = [1e-8, 2e-5 * limits.velocity[:n], 1e-4 * limits.acceleration[:n]][: 3 if jerky else 2]
        for order, scale in enumerate(scales):
            assert (np.abs(ends[order][1:, 0] - ends[order][:-1, -1]) <= scale).all()
            if last is not None:
                assert (np.abs(ends[order][0, 0] - last[order]) <= scale).all()
        last = [end[-1, -1] for end in ends]


def told(live, words):
    """Tell the motion these words at instants ahead; returns when it ends."""
    t = 0.0
    for word, part, other in words:
        end = live.end
        span = 2.0 if end is None else max(end - t, 0.0)
        t += part * span
        if word in ("feed", "rapid"):
            low, high = (0.1, 2.0) if word == "feed" else (0.1, 1.0)
            live.override(t, **{word: low + other * (high - low)})
        elif word == "hold":
            t = live.hold(t)
        elif live.held:
            t = max(t, live.end) + other
            live.resume(t, relight=word == "relight")
    if live.held:
        live.resume(max(t, live.end))
    while live.end is None:
        t += 5.0
        live.state(t)
    return live.end


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_whatever_is_told_limits_hold_and_the_end_is_the_same(motion, name, profile, data):
    machine = machine_of(motion, name)
    program = data.draw(motion.programs(machine))
    path = build(program, machine, continuity=PROFILES[profile].continuity)
    whole = plan(path, machine, program=program, profile=profile)
    live = LivePlan.of(whole, machine)
    end = told(live, data.draw(st.lists(WORDS, max_size=6)))
    portions = list(live.portions(0.0, end))
    limits, jerky = Limits.of(machine), PROFILES[profile].continuity > 1
    for portion in portions:
        check_limits(limits, portion, jerky)
    check_joints(limits, portions, jerky)
    assert live.state(end).position == pytest.approx(whole.position([whole.duration])[0], abs=1e-8)


@pytest.mark.parametrize("profile", sorted(PROFILES))
@given(data=st.data())
def test_untold_it_is_the_trajectory(motion, profile, data):
    machine = machine_of(motion, "mill")
    program = data.draw(motion.programs(machine))
    path = build(program, machine, continuity=PROFILES[profile].continuity)
    whole = plan(path, machine, program=program, profile=profile)
    live = LivePlan.of(whole, machine)
    for portion in live.portions(0.0, whole.duration):
        t = np.linspace(portion.begin, portion.end, 50)
        assert np.abs(portion.position(t) - whole.position(t)).max() <= 1e-9 * (1 + whole.duration)
    assert live.end == pytest.approx(whole.duration, abs=1e-9)
