"""Third-order time optimality of single moves against ruckig, state to state."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from trochia.machine.load import load
from trochia.planner import plan
from trochia.program import MOVE, MoveKind, PathMode, Program
from trochia.toolpath import build

pytestmark = pytest.mark.oracle


def optimum(lengths, limits):
    """The least time of a straight move from rest to rest: one degree of freedom, with what all axes allow along it."""
    ruckig = pytest.importorskip("ruckig")
    given, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
    length = float(np.linalg.norm(lengths))
    given.current_position, given.target_position = [0.0], [length]
    along = [[float(np.min(np.array(limit) / np.abs(lengths / length)))] for limit in limits]
    given.max_velocity, given.max_acceleration, given.max_jerk = along
    assert ruckig.Ruckig(1).calculate(given, found) >= 0
    return found.duration


@pytest.mark.parametrize("seed", range(40))
def test_within_a_tenth_of_a_per_cent(seed):
    chance = np.random.default_rng(seed)
    mill = load("reference-mill")
    scale = 10 ** chance.uniform(-0.7, 0.7, (3, 3))
    axes = tuple(
        dataclasses.replace(axis, velocity=axis.velocity * v, acceleration=axis.acceleration * a, jerk=axis.jerk * j)
        for axis, (v, a, j) in zip(mill.axes, scale, strict=True)
    )
    machine = dataclasses.replace(mill, axes=axes)
    lengths = chance.uniform(-1, 1, 3) * 10 ** chance.uniform(-2, 2.5)
    moves = np.zeros(1, dtype=MOVE)
    moves["kind"], moves["path_mode"], moves["target"][0, :3] = MoveKind.RAPID, PathMode.EXACT_STOP, lengths
    program = Program(name="one", lines=1, start=np.zeros(9), moves=moves, actions=())
    time = plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve").duration
    limits = [[getattr(axis, kind) for axis in axes] for kind in ("velocity", "acceleration", "jerk")]
    assert time == pytest.approx(optimum(lengths, limits), rel=1e-3)
