"""Laws on random programs: no more than all of a limit is ever used, and shaping never uses more than was planned."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.machine.resonance import SHAPERS, Resonance
from trochia.planner import PROFILES, plan
from trochia.toolpath import build

MACHINES = ["capped", "belts"]
RESONANCES = st.none() | st.builds(
    Resonance, frequency=st.floats(5.0, 120.0), damping=st.floats(0.0, 0.5), shaper=st.sampled_from(SHAPERS)
)


def planned(motion, name, profile, data, *, shaped=False):
    machine = motion.machines[name]
    if shaped:
        axes = tuple(dataclasses.replace(axis, resonance=data.draw(RESONANCES)) for axis in machine.axes)
        machine = dataclasses.replace(machine, axes=axes)
    program = data.draw(motion.programs(machine, most=6))
    return plan(
        build(program, machine, continuity=PROFILES[profile].continuity), machine, program=program, profile=profile
    )


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_what_binds_is_never_used_beyond_its_limit(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data)
    binding = trajectory.binding(np.linspace(0.0, trajectory.duration, 1001))
    assert binding.used.max() <= 1.0 + 1e-8  # directions closer than 1e-6 rad count as the same
    assert len(binding.words()) == 1001


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_no_shaper_exceeds_a_limit(motion, name, profile, data):
    trajectory = planned(motion, name, profile, data, shaped=True)
    limits, t = trajectory.limits, np.linspace(0.0, trajectory.duration, 1501)
    velocity, acceleration = trajectory.velocity(t), trajectory.acceleration(t)
    assert (np.abs(velocity @ limits.matrix.T) <= limits.velocity * (1 + 1e-8)).all()
    assert (np.abs(acceleration @ limits.matrix.T) <= limits.acceleration * (1 + 1e-8)).all()
    linear = slice(0, limits.linear)
    assert (np.linalg.norm(velocity[:, linear], axis=1) <= limits.path_velocity * (1 + 1e-8)).all()
    assert (np.linalg.norm(acceleration[:, linear], axis=1) <= limits.path_acceleration * (1 + 1e-8)).all()
    plain = dataclasses.replace(trajectory, shaping=None)
    assert trajectory.position([trajectory.duration]) == pytest.approx(plain.position([trajectory.duration]), abs=1e-9)
