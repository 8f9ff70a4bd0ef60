"""Laws of every trajectory, in every profile: no limit is ever exceeded, nothing jumps, time goes on."""

from __future__ import annotations

import dataclasses
import runpy
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.planner import PROFILES, path_of, plan
from trochia.program import Dwell, MoveKind, PathMode
from trochia.toolpath import build

_STATES = runpy.run_path(str(Path(__file__).parents[1] / "soak" / "phase_states.py"))
inside, derivative, POINTS = (_STATES[name] for name in ("inside", "derivative", "POINTS"))
MACHINES = ["mill", "capped", "belts", "rotary"]
#: the derivatives of place that a profile bounds, and how little each may jump, of its greatest; directions closer
#: than 1e-6 rad count as the same
BOUNDED = {"trapezoid": 2, "s-curve": 3}
JUMPS = [1e-9, 2e-6, 1e-5]

every_profile = pytest.mark.parametrize("profile", sorted(BOUNDED))


def machine_of(motion, name):
    """The machine with jerk limits where its file gives none, and on the vector where it has caps."""
    machine = motion.machines[name]
    axes = tuple(dataclasses.replace(axis, jerk=axis.jerk or 20 * axis.acceleration) for axis in machine.axes)
    caps = dataclasses.replace(machine.path, jerk=15_000.0) if name == "capped" else machine.path
    return dataclasses.replace(machine, axes=axes, path=caps)


def planned(motion, name, profile, data):
    machine = machine_of(motion, name)
    program = data.draw(motion.programs(machine))
    return plan(path_of(program, machine, PROFILES[profile]), machine, program=program, profile=profile)


@every_profile
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_no_limit_is_exceeded_anywhere(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
    limits, linear = trajectory.limits, slice(0, trajectory.limits.linear)
    rows = (limits.velocity, limits.acceleration, limits.jerk)
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    for phases in trajectory.blocks(64):
        states = inside(phases)
        for order in range(1, BOUNDED[profile] + 1):
            asked = derivative(trajectory, states, order)
            assert (np.abs(asked @ limits.matrix.T) <= rows[order - 1] * (1 + 1e-9)).all()
            assert (np.linalg.norm(asked[:, linear], axis=1) <= caps[order - 1] * (1 + 1e-9)).all()


@every_profile
@pytest.mark.parametrize("name", ["mill", "belts"])
@given(data=st.data())
def test_no_feed_is_exceeded(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
    for phases in trajectory.blocks():
        states = inside(phases)
        speed = np.linalg.norm(derivative(trajectory, states, 1), axis=1)
        assert (speed <= trajectory.path.segments["speed_limit"][states["segment"]] * (1 + 1e-9)).all()


@every_profile
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_phases_follow_each_other_without_gap_or_jump(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
    if trajectory.schedule is None:
        return
    phases = np.concatenate(list(trajectory.blocks()))
    assert (phases["duration"] > 0).all()
    assert phases["t"][0] == 0.0
    ends, close = phases["t"] + phases["duration"], 1e-9 * (1 + trajectory.duration)
    assert np.abs(ends[:-1] - phases["t"][1:]).max(initial=0) <= close
    assert abs(ends[-1] - trajectory.duration) <= close
    states = inside(phases)
    for order in range(BOUNDED[profile]):
        value = derivative(trajectory, states, order)
        jump = np.abs(value[POINTS - 1 : -1 : POINTS] - value[POINTS::POINTS]).max(initial=0)
        assert jump <= JUMPS[order] * (np.abs(value).max(initial=1.0) if order else 1.0)
    assert states["v"][-1] == pytest.approx(0.0, abs=1e-6)


@every_profile
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_velocity_is_the_rate_of_position_and_acceleration_that_of_velocity(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
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


@every_profile
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_states_at_given_times_agree_with_the_phases(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
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
def test_a_tolerance_alone_costs_little_time(motion, name, data):
    """Blended everywhere, without weighing where stopping is quicker."""
    machine = motion.machines[name]
    program = data.draw(motion.programs(machine))
    blended = plan(build(program, machine), machine, program=program)
    exact = plan(build(program, machine, blend=False), machine, program=program)
    # beside moves that are slow or short a blend is no longer than they need; what is left is braking while turning
    assert blended.duration <= exact.duration * 1.005 + 1e-3


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_a_tolerance_costs_no_time(motion, name, profile, data):
    machine = machine_of(motion, name)
    program = data.draw(motion.programs(machine))
    blended = plan(path_of(program, machine, PROFILES[profile]), machine, program=program, profile=profile)
    exact = plan(build(program, machine, blend=False), machine, program=program, profile=profile)
    assert blended.duration <= exact.duration * (1 + 1e-9)


@every_profile
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_the_moves_share_the_time_of_motion(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
    assert trajectory.move_times.sum() == pytest.approx(trajectory.times["motion"], rel=1e-9)
    assert (trajectory.move_times >= 0).all()


@every_profile
@pytest.mark.parametrize("name", ["mill", "rotary"])
@given(data=st.data())
def test_what_lies_before_a_stop_does_not_change_what_follows(motion, name, profile, data):
    """Thirty metres behind, where s is known to 4e-12 mm, motion is that of the program alone."""
    machine = machine_of(motion, name)
    program = data.draw(motion.programs(machine))
    led = np.concatenate([program.moves[:1], program.moves])
    led["kind"][0], led["path_mode"][0] = MoveKind.RAPID, PathMode.EXACT_STOP
    start = program.start.copy()
    led["target"][0] = start
    start[0] -= 30_000.0
    rest = (Dwell(at=1, line=1, seconds=1.0),)
    longer = dataclasses.replace(program, start=start, moves=led, actions=rest)
    before = dataclasses.replace(longer, moves=led[:1])
    parts = [
        plan(path_of(part, machine, PROFILES[profile]), machine, program=part, profile=profile).duration
        for part in (before, program, longer)
    ]
    assert parts[0] + parts[1] == pytest.approx(parts[2], abs=1e-10)
