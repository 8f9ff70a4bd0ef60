"""Laws of every jerk-limited trajectory: no limit is ever exceeded, acceleration never jumps, passing costs no time."""

from __future__ import annotations

import dataclasses
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels import scurve
from trochia.planner import PROFILES, path_of, plan
from trochia.program import Dwell, MoveKind, PathMode
from trochia.toolpath import build

SOAK = Path(__file__).parents[1] / "soak"
_STATES = runpy.run_path(str(Path(__file__).parents[1] / "soak" / "phase_states.py"))
inside, derivative, POINTS = (_STATES[name] for name in ("inside", "derivative", "POINTS"))
MACHINES = ["mill", "capped", "belts", "rotary"]


def machine_of(motion, name):
    """The machine with jerk limits where its file gives none, and on the vector where it has caps."""
    machine = motion.machines[name]
    axes = tuple(dataclasses.replace(axis, jerk=axis.jerk or 20 * axis.acceleration) for axis in machine.axes)
    caps = dataclasses.replace(machine.path, jerk=15_000.0) if name == "capped" else machine.path
    return dataclasses.replace(machine, axes=axes, path=caps)


def planned(motion, name, data):
    machine = machine_of(motion, name)
    program = data.draw(motion.programs(machine))
    return plan(path_of(program, machine, PROFILES["s-curve"]), machine, program=program, profile="s-curve")


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_no_limit_is_exceeded_anywhere(motion, name, data):
    trajectory = planned(motion, name, data)
    limits, linear = trajectory.limits, slice(0, trajectory.limits.linear)
    rows = (limits.velocity, limits.acceleration, limits.jerk)
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    for phases in trajectory.blocks(64):
        states = inside(phases)
        for order, (row, cap) in enumerate(zip(rows, caps, strict=True), start=1):
            asked = derivative(trajectory, states, order)
            assert (np.abs(asked @ limits.matrix.T) <= row * (1 + 1e-9)).all()
            assert (np.linalg.norm(asked[:, linear], axis=1) <= cap * (1 + 1e-9)).all()


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
def test_place_velocity_and_acceleration_go_on_without_a_jump(motion, name, data):
    trajectory = planned(motion, name, data)
    if trajectory.schedule is None:
        return
    phases = np.concatenate(list(trajectory.blocks()))
    assert (phases["duration"] > 0).all()
    ends = phases["t"] + phases["duration"]
    assert np.abs(ends[:-1] - phases["t"][1:]).max(initial=0) <= 1e-9 * (1 + trajectory.duration)
    assert ends[-1] == pytest.approx(trajectory.duration, rel=1e-9)
    states = inside(phases)
    # directions closer than 1e-6 rad count as the same
    for order, close in enumerate([1e-9, 2e-6, 1e-5]):
        value = derivative(trajectory, states, order)
        jump = np.abs(value[POINTS - 1 : -1 : POINTS] - value[POINTS::POINTS]).max(initial=0)
        assert jump <= close * (np.abs(value).max(initial=1.0) if order else 1.0)
    assert states["v"][-1] == pytest.approx(0.0, abs=1e-6)


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
    assert trajectory.move_times.sum() == pytest.approx(trajectory.times["motion"], rel=1e-9)


@pytest.mark.parametrize("profile", sorted(PROFILES))
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_a_tolerance_costs_no_time(motion, name, profile, data):
    machine = machine_of(motion, name)
    program = data.draw(motion.programs(machine))
    blended = plan(path_of(program, machine, PROFILES[profile]), machine, program=program, profile=profile)
    exact = plan(build(program, machine, blend=False), machine, program=program, profile=profile)
    assert blended.duration <= exact.duration * (1 + 1e-9)


@pytest.mark.parametrize("seed", [77, 60_668, 30_065_879, 30_074_728, 10_018_943, 10_012_815])
def test_what_was_slower_than_stopping(seed, monkeypatch):
    """By 0.2 to 46 %, when corners were weighed one by one alone."""
    monkeypatch.syspath_prepend(SOAK)
    soak = runpy.run_path(str(SOAK / "plans.py"))
    assert soak["case"](seed, soak["machines"](), [0.0] * 4) == []


def test_no_join_of_the_passes_fails(monkeypatch):
    """Of 3,538 the place where the pass back is joined lay outside what its stretch's ends say."""
    monkeypatch.syspath_prepend(SOAK)
    soak = runpy.run_path(str(SOAK / "plans.py"))
    among, plans = soak["machines"](), []
    once = scurve.Ramps._pass
    monkeypatch.setattr(scurve.Ramps, "_pass", lambda ramps, *rests: (plans.append(0), once(ramps, *rests)))
    for seed in (3_468, 3_538):
        machine = among[seed % len(among)]
        program = soak["program_of"](seed, machine)
        plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve")
    assert len(plans) == 2


@pytest.mark.parametrize("name", ["mill", "rotary"])
@given(data=st.data())
def test_what_lies_before_a_stop_does_not_change_what_follows(motion, name, data):
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
        plan(path_of(part, machine, PROFILES["s-curve"]), machine, program=part, profile="s-curve").duration
        for part in (before, program, longer)
    ]
    assert parts[0] + parts[1] == pytest.approx(parts[2], abs=1e-10)


def test_a_sample_of_the_campaign_of_plans():
    done = subprocess.run([sys.executable, str(SOAK / "plans.py"), "--count", "160"], capture_output=True, text=True,
                          check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "160 programs" in done.stdout
