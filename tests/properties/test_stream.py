"""Laws of streaming: whatever blocks a program comes in, its motion is that of the whole program planned at once."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.planner import PROFILES, corners, path_of, plan
from trochia.planner.live import StreamPlanner, paving, stream
from trochia.program import MOVE, Dwell, MoveKind, Program, Spindle

KINDS = ("walk", "wave", "zig-zag", "hatch", "long lines", "even")
DRAWN = st.tuples(st.sampled_from(KINDS), st.integers(1, 600), st.integers(0, 2**16))


@pytest.fixture(scope="module", autouse=True)
def _small():
    """Pieces and windows so small that a short program has many of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(paving, "_FIRST", 32)
        patch.setattr(paving, "_CHUNK", 64)
        patch.setattr(paving, "REACH", 60)
        patch.setattr(corners, "MOST", 24)
        patch.setattr(stream, "WINDOW", 8.0)
        yield


def points(kind, count, chance):
    u, k = np.arange(1, count + 1) * 0.3, np.arange(count)
    if kind == "walk":
        return np.cumsum(chance.normal(size=(count, 3)) * 10 ** chance.uniform(-2, 1), axis=0)
    if kind == "wave":
        return np.stack([30 * np.sin(u / 20), 20 * np.sin(u / 17), 5 * np.sin(u / 31)], axis=1)
    if kind == "zig-zag":
        return np.stack([u, chance.uniform(0.01, 1) * (k % 2), 0 * u], axis=1)
    if kind == "hatch":
        return np.stack([40.0 * ((k + 1) // 2 % 2), 0.2 * (k // 2), 0 * u], axis=1)
    if kind == "even":  # chords of one length on a curve, so that Q drops points by an even stride
        heading = np.cumsum(0.004 + 0.03 * np.sin(u / chance.uniform(3, 30)) ** 2)
        return np.cumsum(0.3 * np.stack([np.cos(heading), np.sin(heading), 0 * u], axis=1), axis=0)
    return chance.uniform(-200, 200, (count, 3))


def program_of(kind, count, seed):
    """A program of feeds and some rapids, with dwells and a spindle between them."""
    chance = np.random.default_rng(seed)
    moves = np.zeros(count, dtype=MOVE)
    moves["target"][:, :3], moves["line"] = points(kind, count, chance), np.arange(1, count + 1)
    moves["kind"] = np.where(chance.uniform(size=count) < 0.02, MoveKind.RAPID, MoveKind.FEED)
    moves["rate"] = np.where(moves["kind"] == MoveKind.RAPID, 0.0, 10 ** chance.uniform(0.5, 2.3))
    if kind == "even":
        moves["kind"], moves["rate"] = MoveKind.FEED, 100.0
    moves["power"] = 3000.0
    at = sorted(int(a) for a in chance.integers(0, count, 3))
    actions = (
        Spindle(at=at[0], line=1, direction=1, speed=3000.0),
        Dwell(at=at[1], line=1, seconds=0.25),
        Spindle(at=at[2], line=1, direction=0, speed=0.0),
    )
    return Program(name="drawn", lines=count, start=np.zeros(9), moves=moves, actions=actions)


def blocks_of(program, sizes):
    """The program in blocks of these sizes, again and again; each counts from its own start."""
    first, turn, actions = 0, 0, list(program.actions)
    while first < len(program.moves):
        end = min(first + sizes[turn % len(sizes)], len(program.moves))
        own = [a for a in actions if a.at < end]
        actions = actions[len(own) :]
        yield replace(program, moves=program.moves[first:end], actions=tuple(replace(a, at=a.at - first) for a in own))
        first, turn = end, turn + 1


def machine_of(motion):
    machine = motion.machines["mill"]
    return replace(machine, spindle=replace(machine.spindle, spin_up=1.5))


@pytest.mark.parametrize("profile", sorted(PROFILES))
@given(drawn=DRAWN, sizes=st.lists(st.integers(7, 300), min_size=1, max_size=3))
def test_a_stream_is_the_whole(motion, profile, drawn, sizes):
    machine, program = machine_of(motion), program_of(*drawn)
    path = path_of(program, machine, PROFILES[profile])
    whole = plan(path, machine, program=program, profile=profile)
    portions = list(StreamPlanner(blocks_of(program, sizes), machine, profile=profile))
    if not portions:
        assert whole.duration == 0.0
        return
    assert portions[0].begin == 0.0
    assert portions[-1].end == pytest.approx(whole.duration, rel=1e-11, abs=1e-8)  # both are sums over an hour
    for before, after in pairwise(portions):
        assert before.end == pytest.approx(after.begin, abs=1e-9)
    for portion in portions:
        t = np.linspace(portion.begin, portion.end, 200)
        assert np.abs(portion.position(t) - whole.position(t)).max() <= 1e-9 * (1 + whole.duration)
        lasting = portion.phases[portion.phases["duration"] > 1e-9]
        middle = lasting["t"] + 0.5 * lasting["duration"]
        assert (portion.line_at(middle) == whole.line_at(middle)).all()
