"""The twin's steps, counted from sampled commands, against exact step timing: two ways to the same integers."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.errors import lost_steps
from trochia.backends import Twin
from trochia.machine.load import load
from trochia.planner import plan
from trochia.program import MOVE, MoveKind, PathMode, Program
from trochia.pulses.steps import step_blocks
from trochia.recorder import gather
from trochia.toolpath import build

CLOCK = 1_000_000


def program(seed):
    """Return lines of all lengths, blended or not, within 20 mm of 40, 40."""
    random = np.random.default_rng(seed)
    moves = np.zeros(40, MOVE)
    targets = 40 + np.cumsum(random.normal(0, 2, (len(moves), 2)), axis=0).clip(-20, 20)
    moves["target"][:, :2] = targets
    moves["kind"] = random.choice([MoveKind.RAPID, MoveKind.FEED], len(moves))
    moves["rate"] = np.where(moves["kind"] == MoveKind.FEED, random.uniform(1, 40, len(moves)), 0)
    moves["path_mode"] = random.choice([PathMode.BLEND_DEFAULT, PathMode.EXACT_PATH, PathMode.EXACT_STOP], len(moves))
    moves["line"] = np.arange(1, len(moves) + 1)
    start = np.zeros(9)
    start[:2] = targets[0]
    return Program(name="walk.ngc", lines=len(moves), start=start, moves=moves, actions=())


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", ["laser", "corexy"])
def test_twin_stands_on_the_last_step_timed(name, seed):
    machine = load(name)
    walk = program(seed)
    trajectory = plan(build(walk, machine), machine, program=walk)
    twin = Twin(machine=machine, period=0.00173)
    recording = gather(twin.header(trajectory), twin.run(trajectory))
    blocks = list(step_blocks(trajectory, machine, clock=CLOCK))
    t = np.minimum(recording.time, trajectory.duration) * CLOCK
    checked = agreed = joints = 0
    for i, joint in enumerate(machine.joints):
        if joint.steps_per_unit is None:
            continue
        ticks = np.concatenate([block.ticks[i] for block in blocks])
        ways = np.concatenate([block.directions[i] for block in blocks]).astype(np.int64)
        counts = blocks[0].counts[i] + np.concatenate([[0], np.cumsum(ways)])
        place = np.searchsorted(ticks, t, side="right")
        edges = np.concatenate([[-np.inf], ticks, [np.inf]])
        near = np.minimum(t - edges[place], edges[place + 1] - t)
        clear = near > 1.5  # a step's tick is rounded, so a sample this near may be on either side
        clear[-1] = True  # but at the end everything has been stepped
        ahead = recording[f"joint.{joint.name}.steps"] - counts[place]
        # a turn that lies between two samples and takes a boundary with it is seen by step timing alone, until the way
        # back takes the same boundary: the last step and the next one differ in direction
        way = np.concatenate([[0], ways, [0]])
        turning = way[place] == -way[place + 1]
        assert (ahead[clear & ~turning] == 0).all()
        assert (np.abs(ahead[clear]) <= 1).all()
        agreed += np.mean(ahead[clear] == 0)
        joints += 1
        checked += len(ticks)
    assert checked > 1000
    assert agreed / joints > 0.99
    assert set(lost_steps(recording, machine).values()) == {0}
