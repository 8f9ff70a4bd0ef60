"""Laws of every trajectory: no limit is ever exceeded, nothing jumps, time goes on."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.planner import plan
from trochia.toolpath import build

_STATES = runpy.run_path(str(Path(__file__).parents[1] / "soak" / "phase_states.py"))
inside, derivative, POINTS = (_STATES[name] for name in ("inside", "derivative", "POINTS"))
MACHINES = ["mill", "capped", "belts", "rotary"]


def planned(motion, name, data):
    machine = motion.machines[name]
    program = data.draw(motion.programs(machine))
    return plan(build(program, machine), machine, program=program)


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_no_limit_is_exceeded_anywhere(motion, name, data):
    trajectory = planned(motion, name, data)
    limits = trajectory.limits
    for phases in trajectory.blocks(64):
        states = inside(phases)
        velocity, acceleration = derivative(trajectory, states, 1), derivative(trajectory, states, 2)
        assert (np.abs(velocity @ limits.matrix.T) <= limits.velocity * (1 + 1e-9)).all()
        assert (np.abs(acceleration @ limits.matrix.T) <= limits.acceleration * (1 + 1e-9)).all()
        linear = slice(0, limits.linear)
        assert (np.linalg.norm(velocity[:, linear], axis=1) <= limits.path_velocity * (1 + 1e-9)).all()
        assert (np.linalg.norm(acceleration[:, linear], axis=1) <= limits.path_acceleration * (1 + 1e-9)).all()


@pytest.mark.parametrize("name", ["mill", "belts"])
@given(data=st.data())
def test_no_feed_is_exceeded(motion, name, data):
    trajectory = planned(motion, name, data)
    for phases in trajectory.blocks():
        states = inside(phases)
        speed = np.linalg.norm(derivative(trajectory, states, 1), axis=1)
        assert (speed <= trajectory.path.segments["speed_limit"][states["segment"]] * (1 + 1e-9)).all()


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_phases_follow_each_other_without_gap_or_jump(motion, name, data):
    trajectory = planned(motion, name, data)
    if trajectory.schedule is None:
        return
    phases = np.concatenate(list(trajectory.blocks()))
    assert (phases["duration"] > 0).all()
    assert phases["t"][0] == 0.0
    ends = phases["t"] + phases["duration"]
    scale = 1e-12 * (1 + trajectory.duration)
    assert np.abs(ends[:-1] - phases["t"][1:]).max(initial=0) <= 1e3 * scale
    assert abs(ends[-1] - trajectory.duration) <= 1e3 * scale
    states = inside(phases)
    position, velocity = derivative(trajectory, states, 0), derivative(trajectory, states, 1)
    assert np.abs(position[POINTS - 1 : -1 : POINTS] - position[POINTS::POINTS]).max(initial=0) < 1e-9
    # directions closer than 1e-6 rad count as the same
    jump = np.abs(velocity[POINTS - 1 : -1 : POINTS] - velocity[POINTS::POINTS]).max(initial=0)
    assert jump <= 2e-6 * max(1.0, np.abs(velocity).max(initial=0))
    assert states["v"][-1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_velocity_is_the_rate_of_position_and_acceleration_that_of_velocity(motion, name, data):
    trajectory = planned(motion, name, data)
    if trajectory.schedule is None:
        return
    phases = np.concatenate(list(trajectory.blocks()))
    longest = phases[np.argmax(phases["duration"])]
    h = longest["duration"] * 1e-4
    t = longest["t"] + longest["duration"] * np.linspace(0.1, 0.9, 9)
    for value, rate in ((trajectory.position, trajectory.velocity), (trajectory.velocity, trajectory.acceleration)):
        estimate = (value(t + h) - value(t - h)) / (2 * h)
        rounding = 1e-15 * (np.abs(value(t)).max() + 1) / h
        assert np.allclose(estimate, rate(t), rtol=1e-5, atol=1e-5 * np.abs(rate(t)).max() + 10 * rounding)


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_states_at_given_times_agree_with_the_phases(motion, name, data):
    trajectory = planned(motion, name, data)
    if trajectory.schedule is None:
        return
    phases = np.concatenate(list(trajectory.blocks(5)))
    middle = phases["t"] + phases["duration"] / 2
    states = inside(phases)[POINTS // 2 :: POINTS]
    assert np.allclose(trajectory.position(middle), derivative(trajectory, states, 0), atol=1e-9)
    shuffled = data.draw(st.permutations(range(len(middle))))
    assert np.array_equal(trajectory.position(middle[shuffled]), trajectory.position(middle)[shuffled])


@pytest.mark.parametrize("name", ["mill", "capped"])
@given(data=st.data())
def test_a_tolerance_does_not_cost_time(motion, name, data):
    machine = motion.machines[name]
    program = data.draw(motion.programs(machine))
    blended = plan(build(program, machine), machine, program=program)
    exact = plan(build(program, machine, blend=False), machine, program=program)
    # beside moves that are slow or short a blend is no longer than they need; what is left is braking while turning
    assert blended.duration <= exact.duration * 1.005 + 1e-3


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_the_moves_share_the_time_of_motion(motion, name, data):
    trajectory = planned(motion, name, data)
    assert trajectory.move_times.sum() == pytest.approx(trajectory.times["motion"], rel=1e-9)
    assert (trajectory.move_times >= 0).all()
