"""The time base against its own equations, and motion on it against differences."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.planner.timebase import TimeBase, Timed
from trochia.toolpath import build


@pytest.fixture(scope="module")
def trajectory():
    machine = load("reference-mill")
    program = gcode.read("G64 P0.05\nF6000\nG1 X40\nG3 X60 Y20 J20\nG1 Y60\nM2\n")
    return plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve")


def test_even_time_is_time():
    base = TimeBase.even()
    assert base.at([0.0, 2.5]) == pytest.approx([0.0, 2.5])
    assert TimeBase.even(0.25, t=1.0, u=8.0).at([3.0]) == pytest.approx([8.5])


def test_a_change_of_rate_takes_the_time_of_its_bounds():
    base = TimeBase.even().slewed(1.0, 0.0, slew=4.0, twist=40.0)
    assert base.t[-1] == pytest.approx(1.0 + 1.0 / 4.0 + 4.0 / 40.0)  # change / slew + slew / twist
    assert base.at([base.t[-1]], 1) == pytest.approx([0.0], abs=1e-12)
    t = np.linspace(0, 2, 2001)
    assert np.abs(base.at(t, 2)).max() <= 4.0 + 1e-12
    assert base.at([9.0]) == pytest.approx(1.0 + 0.5 * (base.t[-1] - 1.0))  # mean rate of a symmetric change: a half


def test_without_a_bound_on_the_twist_the_slew_jumps():
    base = TimeBase.even().slewed(0.5, 0.2, slew=2.0)
    assert base.t[-1] == pytest.approx(0.5 + 0.8 / 2.0)
    assert base.at([0.7], 2) == pytest.approx([-2.0])


def test_stop_and_go_on_is_the_same_motion_later(trajectory):
    base = TimeBase.even().slewed(0.3, 0.0, slew=5.0, twist=80.0).slewed(2.0, 1.0, slew=5.0, twist=80.0)
    timed = Timed(trajectory=trajectory, base=base)
    late = float(base.at([10.0])[0])
    assert timed.position([10.0]) == pytest.approx(trajectory.position([late]))


def test_derivatives_agree_with_differences(trajectory):
    base = TimeBase.even().slewed(0.2, 0.3, slew=3.0, twist=30.0).slewed(1.2, 0.9, slew=2.0, twist=30.0)
    timed, h = Timed(trajectory=trajectory, base=base), 1e-5
    t = np.random.default_rng(4).uniform(0.01, 1.9, 400)
    clear = np.abs(t[:, None] - base.t[None, :]).min(axis=1) > 2 * h
    own = np.concatenate([b["t"] for b in trajectory.blocks()])
    clear &= np.abs(base.at(t)[:, None] - own[None, :]).min(axis=1) > 2 * h
    t = t[clear]
    assert len(t) > 200
    for low, high in ((timed.position, timed.velocity), (timed.velocity, timed.acceleration),
                      (timed.acceleration, timed.jerk)):  # fmt: skip
        difference = (low(t + h) - low(t - h)) / (2 * h)
        assert difference == pytest.approx(high(t), rel=1e-4, abs=1e-3 * max(1.0, np.abs(high(t)).max()))


@pytest.mark.parametrize("rows", [
    [],
    [(0.0, 0.0, -1.0, 0.0, 0.0)],
    [(0.0, 0.0, 1.0, 1.0, 0.0)],
    [(0.0, 0.0, 1.0, 0.0, 0.0), (0.0, 1.0, 1.0, 0.0, 0.0)],
])  # fmt: skip
def test_what_is_no_time_base_is_refused(rows):
    with pytest.raises(ValueError):
        TimeBase.of(rows)


def test_a_rate_is_changed_only_while_it_is_even():
    base = TimeBase.even().slewed(0.0, 0.0, slew=1.0)
    with pytest.raises(ValueError, match="even"):
        base.slewed(0.5, 1.0, slew=1.0)
