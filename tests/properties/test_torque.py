"""Laws of the torque profile: no row is ever accelerated by more than its curve leaves at its speed, nothing jumps."""

from __future__ import annotations

import dataclasses
import runpy
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels import path as kernel
from trochia.machine.acceleration import AccelerationCurve
from trochia.planner import plan
from trochia.toolpath import build

_STATES = runpy.run_path(str(Path(__file__).parents[1] / "soak" / "phase_states.py"))
inside, POINTS = (_STATES[name] for name in ("inside", "POINTS"))
MACHINES = ["mill", "capped", "belts", "rotary"]


@st.composite
def curves(draw):
    count = draw(st.integers(1, 5))
    speeds = np.cumsum(draw(st.lists(st.floats(1.0, 120.0), min_size=count, max_size=count)))
    values = sorted(draw(st.lists(st.floats(5.0, 4000.0), min_size=count, max_size=count)), reverse=True)
    return AccelerationCurve(knots=tuple(zip(speeds.tolist(), values, strict=True)))


def planned(motion, name, data):
    machine = motion.machines[name]
    axes = tuple(dataclasses.replace(axis, acceleration_curve=data.draw(st.none() | curves())) for axis in machine.axes)
    machine = dataclasses.replace(machine, axes=axes)
    program = data.draw(motion.programs(machine))
    return plan(build(program, machine), machine, program=program, profile="torque")


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_no_limit_is_exceeded_at_any_speed(motion, name, data):
    trajectory = planned(motion, name, data)
    limits, path = trajectory.limits, trajectory.path
    linear = slice(0, limits.linear)
    for phases in trajectory.blocks(64):
        states = inside(phases)
        velocity, acceleration = (kernel.sample(path.segments, path.pool, len(path.axes), states, k) for k in (1, 2))
        speeds = velocity @ limits.matrix.T
        assert (np.abs(speeds) <= limits.velocity * (1 + 1e-9)).all()
        assert (np.abs(acceleration @ limits.matrix.T) <= limits.acceleration_at(speeds) * (1 + 1e-9)).all()
        assert (np.linalg.norm(velocity[:, linear], axis=1) <= limits.path_velocity * (1 + 1e-9)).all()
        assert (np.linalg.norm(acceleration[:, linear], axis=1) <= limits.path_acceleration * (1 + 1e-9)).all()
        if limits.linear == len(path.axes):
            feed = path.segments["speed_limit"][states["segment"]]
            assert (np.linalg.norm(velocity, axis=1) <= feed * (1 + 1e-9)).all()


@pytest.mark.parametrize("name", ["belts"])
@given(data=st.data())
def test_phases_follow_each_other_without_gap_or_jump(motion, name, data):
    trajectory = planned(motion, name, data)
    if trajectory.schedule is None:
        return
    phases = np.concatenate(list(trajectory.blocks(7)))
    ends = phases["t"] + phases["duration"]
    assert (phases["duration"] > 0).all()
    assert np.abs(ends[:-1] - phases["t"][1:]).max(initial=0) <= 1e-9 * (1 + trajectory.duration)
    assert abs(ends[-1] - trajectory.duration) <= 1e-9 * (1 + trajectory.duration)
    states = inside(phases)
    position = kernel.sample(trajectory.path.segments, trajectory.path.pool, len(trajectory.path.axes), states, 0)
    assert np.abs(position[POINTS - 1 : -1 : POINTS] - position[POINTS::POINTS]).max(initial=0) < 1e-8
    speed = states["v"]
    jump = np.abs(speed[POINTS - 1 : -1 : POINTS] - speed[POINTS::POINTS]).max(initial=0)
    assert jump <= 1e-6 * max(1.0, speed.max())
    assert speed[-1] == pytest.approx(0.0, abs=1e-6)
    middle = phases["t"] + phases["duration"] / 2
    assert np.allclose(trajectory.path_speed(middle), speed[POINTS // 2 :: POINTS], rtol=1e-6, atol=1e-6)
