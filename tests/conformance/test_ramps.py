"""Every law of motion in the registry: whole time against the closed form, monotone ramps, both ways the same."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from trochia.pulses.ramps import RAMPS, Demand, Ramp, TorqueCurve, profile
from trochia.pulses.ramps.exact import total
from trochia.pulses.ramps.torque import SAFE

demands = st.builds(
    Demand,
    steps=st.integers(1, 600),
    speed=st.floats(5.0, 20_000.0),
    acceleration=st.floats(50.0, 200_000.0),
    deceleration=st.none() | st.floats(50.0, 200_000.0),
    update=st.floats(1e-4, 5e-3),
)
curves = st.builds(
    lambda first, falls, gaps: TorqueCurve(
        speeds=tuple(np.cumsum(gaps[: len(falls) + 1]).tolist()),
        torques=tuple((first * np.cumprod([1.0, *falls])).tolist()),
    ),
    st.floats(0.1, 2.0),
    st.lists(st.floats(0.5, 1.05), min_size=1, max_size=4),
    st.lists(st.floats(20.0, 800.0), min_size=5, max_size=5),
)


def equipped(ramp: Ramp, demand: Demand, curve: TorqueCurve) -> Demand:
    """Return the demand with what the law needs, its speed in the motor's reach."""
    if not ramp.by_torque:
        return demand
    load = 0.3 * min(curve.torques)
    speed = min(demand.speed, SAFE * curve.reach(load))
    return replace(demand, curve=curve, load=load, inertia=2e-4, speed=speed)


@pytest.mark.parametrize("ramp", RAMPS.values(), ids=RAMPS)
@given(demand=demands, curve=curves)
@settings(max_examples=40, deadline=None)
def test_laws(ramp: Ramp, demand: Demand, curve: TorqueCurve):
    asked = equipped(ramp, demand, curve)
    made = profile(asked, ramp.name)
    assert made.delays.size == asked.steps
    assert np.isfinite(made.delays).all()
    assert (made.delays > 0.0).all()
    assert made.peak <= asked.speed * (1.0 + 1e-9)  # never faster than asked
    assert made.duration >= asked.steps / asked.speed * (1.0 - 1e-9)
    table = made.columns()
    assert table["elapsed_ticks"] + table["ticks"] == pytest.approx(table["time_s"] * asked.clock)


@pytest.mark.parametrize("ramp", RAMPS.values(), ids=RAMPS)
@given(demand=demands, curve=curves)
@settings(max_examples=40, deadline=None)
def test_speed_rises_then_falls(ramp: Ramp, demand: Demand, curve: TorqueCurve):
    made = profile(equipped(ramp, demand, curve), ramp.name)
    top = int(np.argmin(made.delays))
    room = 1e-9 * made.duration
    assert (np.diff(made.delays[: top + 1]) <= room).all()
    assert (np.diff(made.delays[top:]) >= -room).all()


@pytest.mark.parametrize("ramp", [row for row in RAMPS.values() if not row.by_torque], ids=lambda row: row.name)
@given(demand=demands)
@settings(max_examples=60, deadline=None)
def test_whole_time_against_the_closed_form(ramp: Ramp, demand: Demand):
    peak = min(demand.speed, math.sqrt(2.0 * demand.steps / (1.0 / demand.rising + 1.0 / demand.falling)))
    ramp_steps = peak**2 / (2.0 * max(demand.rising, demand.falling))
    rounded = 0.0
    if ramp.slack:  # a recursion's ramps are whole steps
        assume(ramp_steps >= 10.0)
        rounded = 1.0 / ramp_steps
    slack = ramp.slack * (math.sqrt(2.0 / demand.rising) + math.sqrt(2.0 / demand.falling))
    exact = total(demand)
    assert profile(demand, ramp.name).duration == pytest.approx(exact, abs=slack + (rounded + 1e-9) * exact)


@pytest.mark.parametrize("name", ["exact", "linear"])
@given(demand=demands)
@settings(max_examples=40, deadline=None)
def test_equal_ramps_are_the_same_both_ways(name: str, demand: Demand):
    made = profile(replace(demand, deceleration=None), name)
    assert made.delays[::-1] == pytest.approx(made.delays, rel=1e-7, abs=1e-12 * made.duration)


@given(demand=demands, curve=curves)
@settings(max_examples=40, deadline=None)
def test_torque_is_never_exceeded(demand: Demand, curve: TorqueCurve):
    """Between two delays the speed cannot rise faster than the greatest torque on the way allows."""
    asked = equipped(RAMPS["torque"], demand, curve)
    made = profile(asked, "torque")
    most = max(curve.torques) / (asked.inertia * asked.step_angle)
    assert (np.abs(made.accelerations) <= (most + asked.load / (asked.inertia * asked.step_angle)) * (1 + 1e-6)).all()


@given(demand=demands)
@settings(max_examples=40, deadline=None)
def test_linear_tends_to_exact(demand: Demand):
    """With the speed set anew ever oftener, the times of the steps are the exact ones: chords under a parabola."""
    errors = []
    for update in (2e-3, 1e-4):
        times = profile(replace(demand, update=update), "linear").times
        errors.append(np.abs(times - profile(demand).times).max())
    # at worst the first step: within one setting of its own time
    assert errors[1] <= 1e-4 + 1e-9
    assert errors[0] <= 2e-3 + 1e-9
