"""The road of a program that comes in pieces: numbers, memory, views."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.kernels import path as kernel
from trochia.kernels.layout import MOVE, PHASE, SEGMENT
from trochia.planner.live.held import Held
from trochia.planner.live.road import Road, Stretch
from trochia.planner.live.rows import Reused

AXES = "XY"


def stretch(rng, count, first_move, rests=()):
    """Lines of the moves from ``first_move`` on, one each, in a pool that begins somewhere."""
    before = int(rng.integers(0, 5))
    segments = np.zeros(count, dtype=SEGMENT)
    segments["length"] = rng.uniform(1.0, 2.0, count)
    segments["move"], segments["data"] = np.arange(count), before + 4 * np.arange(count)
    moves = np.zeros(count, dtype=MOVE)
    moves["line"], moves["power"] = 10 * (first_move + np.arange(count)), first_move + np.arange(count)
    return Stretch(segments=segments, pool=rng.uniform(size=4 * count), moves=moves, first_move=first_move,
                   rests=np.array(rests, dtype=np.uint64), seconds=np.ones(len(rests)), start=np.zeros(2))  # fmt: skip


def coefficients(rows, pool):
    return np.array([pool[int(at) : int(at) + 4] for at in rows["data"]]).reshape(-1, 4)


def test_rows_keep_their_numbers_and_coefficients_however_they_come_and_go():
    rng = np.random.default_rng(1)
    sizes = [int(n) for n in rng.integers(1, 40, 30)]
    stretches = [stretch(rng, n, sum(sizes[:k]), rests=[n // 2]) for k, n in enumerate(sizes)]
    pools = np.concatenate([part.pool.reshape(-1, 4) for part in stretches])
    lengths = np.concatenate([part.segments["length"] for part in stretches])
    road, dropped, views = Road(AXES, iter(stretches)), 0, []
    while road.more():
        rows = road.rows(dropped, road.end)
        assert (rows["length"] == lengths[dropped : road.end]).all()
        assert (rows["move"] == np.arange(dropped, road.end)).all()
        assert (road.lines(dropped, road.end) == 10 * rows["move"]).all()
        assert (road.power(dropped, road.end) == rows["move"]).all()
        assert (coefficients(rows, road.pool) == pools[dropped : road.end]).all()
        views.append((dropped, road.end, rows, road.pool))
        dropped += int(rng.integers(0, road.end - dropped + 1))
        road.trim(dropped)
        assert road.base == dropped
        assert (road.rests >= dropped).all()
    assert road.ended
    assert road.end == sum(sizes)
    for first, end, rows, pool in views:  # what was given out is still what it was
        assert (coefficients(rows, pool) == pools[first:end]).all()


def test_memory_is_that_of_what_is_in_hand():
    rng = np.random.default_rng(2)
    road = Road(AXES, (stretch(rng, 50, 50 * k) for k in range(200)))
    while road.more():
        road.trim(max(road.end - 60, 0))
        assert road.segments.base is not None
        assert len(road.segments.base) <= 3 * (60 + 50)


def test_a_whole_path_is_not_copied():
    part = stretch(np.random.default_rng(3), 20, 0)
    road = Road.whole(AXES, part)
    assert np.shares_memory(road.segments, part.segments)
    assert np.shares_memory(road.pool, part.pool)
    assert not road.more()
    road.trim(5)
    assert (road.lines(5, 20) == 10 * np.arange(5, 20)).all()
    assert (road.power(5, 20) == np.arange(5, 20)).all()


@pytest.mark.parametrize("sizes", [[100], [7, 93], [1] * 100, [40, 1, 1, 58]])
def test_moves_in_hand_are_those_of_all_blocks(sizes):
    moves = np.zeros(100, dtype=MOVE)
    moves["line"] = np.arange(100)
    held, first = Held(), 0
    for size in sizes:
        block = moves[first : first + size]
        held.take(block, 0, size // 2)
        held.take(block, size // 2, size)
        first += size
        keep = max(held.end - 30, 0)
        assert (held.since(keep)["line"] == np.arange(keep, held.end)).all()
        held.drop(max(keep - 5, 0))
        assert (held.since(keep)["line"] == np.arange(keep, held.end)).all()
    assert (held.base, held.end) == (65, 100)


def test_moves_of_one_block_are_not_copied():
    moves = np.zeros(100, dtype=MOVE)
    held = Held()
    held.take(moves, 0, 60)
    held.drop(20)
    held.take(moves, 60, 100)
    assert np.shares_memory(held.since(30), moves)


def test_memory_is_taken_again_when_nobody_looks_at_it():
    memory = Reused(np.float64)
    first = memory.take(100)
    second = memory.take(100)
    assert not np.shares_memory(first, second)
    view = first[3:7]
    del first
    third = memory.take(100)
    assert not np.shares_memory(third, view)  # somebody still looks at it
    at = view.__array_interface__["data"][0] - 3 * view.itemsize
    del view
    assert memory.take(100).__array_interface__["data"][0] == at
    assert len(memory.take(1000)) >= 1000


def test_rows_are_reached_by_the_time_they_take():
    rows = np.zeros(4, dtype=SEGMENT)
    rows["length"], rows["speed_limit"] = [10.0, 20.0, 30.0, 40.0], [10.0, 10.0, np.inf, 10.0]
    assert kernel.reach(rows, 2.0, feed=1.0, most=15.0) == (2, -1.0)  # 1 s, 2 s
    assert kernel.reach(rows, 100.0, feed=0.5, most=15.0) == (4, 100.0 - 2.0 - 4.0 - 2.0 - 8.0)
    assert kernel.reach(rows, 0.0, feed=1.0, most=15.0) == (0, 0.0)


def test_phases_are_moved_in_time_and_along_the_road():
    phases = np.zeros(3, dtype=PHASE)
    phases["t"], phases["segment"], phases["v"] = [0.0, 1.0, 2.5], [7, 7, 9], [1.0, 2.0, 3.0]
    moved = np.empty(3, dtype=PHASE)
    kernel.move_phases(phases, moved, later=0.5, rows=-7)
    assert (moved["t"] == [0.5, 1.5, 3.0]).all()
    assert (moved["segment"] == [0, 0, 2]).all()
    assert (moved["v"] == phases["v"]).all()
    with pytest.raises(ValueError, match="as many rows"):
        kernel.move_phases(phases, moved[:2])
