"""The driver's demands: where direction edges lie, what is refused, how fast the steps come."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.layout import PHASE, SEGMENT
from trochia.machine.joints import PulseTiming
from trochia.machine.load import load
from trochia.pulses import PulseCheck, StepBlock
from trochia.pulses.timing import Demand

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

CLOCK = 1_000_000


def machine_of(rate: float | None = None, **timing: float) -> Machine:
    machine = load("laser")
    first = replace(machine.joints[0], pulses=PulseTiming(**timing), pulse_rate=rate)
    return replace(machine, joints=(first, *machine.joints[1:]))


def block_of(ticks: list[int], ways: list[int], start: int = 0) -> StepBlock:
    phases = np.zeros(2, PHASE)
    phases["t"], phases["duration"], phases["segment"] = [0.0, 50e-6], [50e-6, 1.0], [0, 1]
    none = np.empty(0, np.int64)
    return StepBlock(
        start=start, end=max(ticks, default=start), clock=CLOCK, counts=(0, 0),
        ticks=(np.array(ticks, dtype=np.int64), none), directions=(np.array(ways, dtype=np.int8), none.astype(np.int8)),
        phases=phases,
    )  # fmt: skip


def check_of(machine: Machine) -> PulseCheck:
    segments = np.zeros(2, SEGMENT)
    segments["move"] = [11, 12]
    return PulseCheck(machine=machine, segments=segments, clock=CLOCK)


TIMING = {"length": 2e-6, "space": 3e-6, "setup": 4e-6, "hold": 6e-6}


def test_demands_are_whole_ticks_rounded_up() -> None:
    demand = Demand.of(machine_of(length=1.1e-6, space=0.2e-6, setup=3e-6, hold=5e-6).joints[0], CLOCK)
    assert (demand.length, demand.space, demand.setup, demand.hold) == (2, 1, 3, 5)
    assert (demand.interval, demand.turn) == (3, 8)
    assert Demand.of(machine_of(rate=30_000.0, **TIMING).joints[0], CLOCK).interval == 34


def test_an_edge_lies_in_the_middle_of_the_free_gap() -> None:
    """Steps at 100 forwards and 130 back: hold until 106, set-up from 126, so the edge is at 116."""
    check = check_of(machine_of(**TIMING))
    (edges, ways), _ = check.add(block_of([100, 130], [1, -1]))
    assert edges.tolist()[1:] == [116]
    assert ways.tolist() == [1, -1]
    assert edges[0] <= 96
    assert check.first is None


def test_the_least_gap_is_just_enough() -> None:
    check = check_of(machine_of(**TIMING))
    (edges, _), _ = check.add(block_of([100, 105, 110, 120, 125], [1, 1, 1, -1, -1]))
    assert check.violations == 0
    assert edges.tolist()[1:] == [116]


def test_a_step_too_soon_is_named_with_its_move() -> None:
    check = check_of(machine_of(**TIMING))
    check.add(block_of([10, 20, 24, 100, 109], [1, 1, 1, 1, -1]))
    assert check.violations == 2
    first = check.first
    assert first is not None
    assert (first.tick, first.gap, first.needed, first.turn, first.move) == (24, 4, 5, False, 11)
    assert "joint X" in str(first)
    assert "4.000 µs" in str(first)
    assert "5.000 µs" in str(first)


def test_a_turn_too_soon_is_named_so() -> None:
    check = check_of(machine_of(**TIMING))
    check.add(block_of([100, 109], [1, -1]))
    first = check.first
    assert first is not None
    assert (first.gap, first.needed, first.turn, first.move) == (9, 10, True, 12)
    assert "direction" in str(first)


def test_the_first_violation_stays_the_first() -> None:
    check = check_of(machine_of(**TIMING))
    check.add(block_of([10, 14], [1, 1]))
    check.add(block_of([100, 101], [1, 1]))
    assert check.violations == 2
    assert check.first is not None
    assert check.first.tick == 14


def test_demands_hold_across_blocks() -> None:
    check = check_of(machine_of(**TIMING))
    check.add(block_of([100], [1]))
    (edges, _), _ = check.add(block_of([108], [-1]))
    assert check.violations == 1
    assert edges.tolist() == [106]  # hold is kept, so it is the set-up that falls short


def test_the_drivers_rate_is_a_demand_too() -> None:
    check = check_of(machine_of(rate=100_000.0, **TIMING))
    check.add(block_of([100, 109], [1, 1]))
    assert check.first is not None
    assert check.first.needed == 10


def test_the_highest_rate_is_of_the_shortest_interval() -> None:
    check = check_of(machine_of(**TIMING))
    assert check.highest_rates()["X"] == 0.0
    check.add(block_of([0], [1]))
    assert check.highest_rates()["X"] == 0.0
    check.add(block_of([50, 150, 170], [1, 1, 1]))
    check.add(block_of([], []))
    assert check.highest_rates() == {"X": pytest.approx(50_000.0), "Y": 0.0}
    assert check.steps() == {"X": 4, "Y": 0}


@given(st.lists(st.tuples(st.integers(10, 60), st.sampled_from([1, -1])), min_size=1, max_size=30), st.integers(0, 30))
def test_edges_keep_set_up_and_hold_whatever_comes(rows: list[tuple[int, int]], cut: int) -> None:
    """Gaps of ten ticks and more: nothing is refused, and every edge is hold after and set-up before a step."""
    ticks = np.cumsum([gap for gap, _ in rows]).tolist()
    ways = [way for _, way in rows]
    check = check_of(machine_of(**TIMING))
    edges: list[int] = []
    for part in (slice(None, cut), slice(cut, None)):
        edges += check.add(block_of(ticks[part], ways[part]))[0][0].tolist()
    assert check.violations == 0
    turns = [k for k in range(len(ways)) if k == 0 or ways[k] != ways[k - 1]]
    assert len(edges) == len(turns)
    for edge, k in zip(edges, turns, strict=True):
        assert edge <= ticks[k] - 4
        assert k == 0 or edge >= ticks[k - 1] + 6
