"""Tick segments executed in the step interrupt: every step when the host's run of the same code has it.

Rows of a segment: interval [2^-8 ticks], add, add2, count, stride, flags.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pytest

from trochia.kernels.ticks import BACKWARDS, PAUSE, SCALE, SEGMENT, SegmentFit, SegmentRun, speed_move

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from trochia.backends.simulated_chip import SimulatedChip

COMPARE_A = 11  # the vector's number
BEGIN = 1000  # cycles from B1's edge to the start of the first interval, about
LATENCY = 24  # from match to pulse on the short way, and whatever instruction was under way


class Executed(NamedTuple):
    late: NDArray[np.int64]
    edges: NDArray[np.int64]
    directions: NDArray[np.int64]
    cycles: float  # a step


@pytest.fixture
def execute(start: Callable[[str], SimulatedChip], image: Callable[[str], Path],
            symbols: Callable[[Path], dict[str, int]]):  # fmt: skip
    def run(segments: list[tuple[int, ...]]) -> Executed:
        chip, places, rows = start("stepping"), symbols(image("stepping")), np.array(segments, SEGMENT)
        chip.run_until(20_000)
        chip.write_memory(places["rows"], rows.tobytes())
        chip.write_memory(places["row_count"], bytes([rows.size]))
        chip.write_memory(places["go"], b"\1")
        planned = np.cumsum(SegmentRun().intervals(rows), dtype=np.int64)
        made = chip.run_until(20_000 + int(planned[-1]) + 100_000)
        still = np.repeat(rows["flags"] & PAUSE, rows["count"]).astype(bool)
        edges = made.edges("D2", 1).astype(np.int64)
        assert edges.size == planned[~still].size  # none lost, none doubled
        turns = made.edges("D3").astype(np.int64)
        taken, mean, _ = chip.interrupts()[COMPARE_A]  # late steps share one
        begin = int(made.edges("B1")[0]) + BEGIN
        directions = np.searchsorted(turns, edges) & 1
        return Executed(edges - begin - planned[~still], edges, directions, taken * mean / edges.size)

    return run


def steady(interval: float, count: int, stride: int) -> tuple[int, ...]:
    return (round(interval * 256), 0, 0, count, stride, 0)


@pytest.mark.parametrize(("rate", "stride"), [(160_000, 16), (200_000, 64)])
def test_sustained_rates_of_one_motor(execute: Callable[..., Executed], rate: int, stride: int):
    done = execute([steady(16e6 / rate, 500, stride)] * 40)
    settled = done.late[20:-1]  # the first and the last step take the long way
    assert settled.max() <= 160  # 10 us; a bend takes 110 cycles longer, and the steps after it catch up
    assert settled.mean() < LATENCY + 20
    assert done.late.max() < 320
    assert np.diff(done.edges).min() >= 64  # 4 us
    assert done.cycles < 16e6 / rate  # what a step costs, all included


def test_a_step_costs_what_the_page_says(execute: Callable[..., Executed]):
    assert execute([steady(300, 5000, 255)]).cycles == pytest.approx(71.5, abs=0.5)
    assert execute([steady(300, 5000, 1)]).cycles == pytest.approx(188, abs=2)


def test_acceleration_within_segments(execute: Callable[..., Executed]):
    """From 4000 to 57,000 steps/s: each step bends the interval, and the cubic term as well."""
    up = (4000 * 256, -(2**24) * 27, 2**24 // 9, 250, 1, 0)
    done = execute([up, steady(600, 500, 8)])
    assert done.edges.size == 750
    assert np.ptp(done.late[:250]) <= 12
    assert np.diff(done.edges)[248] < 800


def test_pauses_turns_and_long_intervals(execute: Callable[..., Executed]):
    rows = [
        steady(900, 40, 4),
        (70_000 * 256, 0, 0, 3, 1, PAUSE),
        (1200 * 256, 0, 0, 20, 4, BACKWARDS),
        (200_000 * 256 + 77, -30_000, 9, 5, 1, BACKWARDS | SCALE),
        steady(900, 12, 5),
    ]
    done = execute(rows)
    assert (abs(done.late - np.median(done.late)) <= 400).all()
    assert done.directions.tolist() == [0] * 40 + [1] * 25 + [0] * 12


@pytest.mark.parametrize("seed", range(6))
def test_random_segments(execute: Callable[..., Executed], seed: int):
    rng = np.random.default_rng(seed)
    rows: list[tuple[int, ...]] = []
    for _ in range(30):
        interval, count, stride = int(2 ** rng.uniform(9.4, 12)), int(rng.integers(1, 120)), int(rng.integers(1, 40))
        add = int(rng.integers(-(2**24), 2**24)) * interval // (200 * max(1, count // stride))
        rows.append((interval * 256 + int(rng.integers(256)), add, 0, count, stride, int(rng.integers(2))))
    done = execute(rows)
    assert (done.late > -2).all()
    assert (done.late < 480).all()  # right after a segment is taken up; half a step at the fastest of these
    assert np.median(done.late) < LATENCY


def test_a_planned_move_at_160_000_steps_a_second(execute: Callable[..., Executed]):
    """From rest to rest: plan, segments, interrupt, pin: every step within 10 us of the plan's exact time."""
    per_step, counts = round(2 * 16e6**2 / 2e6), (6400, 17_200, 6400)
    planned = np.cumsum(speed_move(per_step, per_step, counts, 100 * 256)[0], dtype=np.int64)
    segments = SegmentFit(tolerance=16).fit(planned)
    done = execute([tuple(int(value) for value in row) for row in segments.tolist()])
    made = np.cumsum(SegmentRun().intervals(segments), dtype=np.int64)
    off = done.late + made - planned
    assert off.size == 30_000
    assert np.abs(off - np.median(off))[20:-1].max() < 160  # 10 us
    assert np.abs(off - np.median(off)).max() < 320
    assert np.percentile(np.abs(off - np.median(off)), 95) < 50  # half a step at full speed
