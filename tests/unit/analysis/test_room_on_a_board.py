"""How far a plan's feed can go on a board, found from its busy stretches: the same verdict as from all of it."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

import trochia
from trochia.analysis.board import TOO_MUCH, board_problems, most_feed, room_on

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan
    from trochia.machine.machine import Machine

UNO = ("uno-stepdir", 1_000_000)


@pytest.fixture
def machine() -> Machine:
    made = trochia.load("reference-mill")
    axes = tuple(replace(axis, velocity=300.0, acceleration=2000.0, jerk=100_000.0) for axis in made.axes)
    return replace(made, axes=axes, joints=tuple(replace(joint, pulse_rate=None) for joint in made.joints))


def planned(text: str, machine: Machine) -> Plan:
    return trochia.plan(trochia.gcode("G21 G90 G17 G64 P0.02 " + text + "\nM2\n", machine), machine)


LINE = "F{}\nG1 X60 Y50\nX0 Y0"
THREE = "F{}\nG1 X60 Y50 Z40\nX0 Y0 Z0"
ARC = "F{}\nG3 X40 Y0 I20\nG3 X0 Y0 I-20"
SHORT = "F{}\n" + "\n".join(f"G1 X{0.2 * i:.3f} Y{0.1 * (i % 3):.3f}" for i in range(200))


@pytest.mark.parametrize("text", [LINE, THREE, ARC, SHORT], ids=["line", "three", "arc", "short"])
@pytest.mark.parametrize("feed", [300, 3000, 6000, 20000])
def test_the_verdict_is_that_of_the_whole(machine: Machine, text: str, feed: int) -> None:
    plan = planned(text.format(feed), machine)
    whole = [problem for problem in board_problems(plan, *UNO) if problem.code == TOO_MUCH]
    room = room_on(plan, *UNO)
    assert (room.problem is not None) == bool(whole)
    assert (room.most < 1.0) == bool(whole)
    if whole:
        assert room.problem is not None
        assert room.problem.line == whole[0].line


def test_a_slow_feed_has_all_the_room_there_is_and_a_fast_one_less(machine: Machine) -> None:
    rooms = [room_on(planned(LINE.format(feed), machine), *UNO).most for feed in (600, 6000, 9000)]
    assert rooms[0] == 2.0
    assert rooms[0] >= rooms[1] > rooms[2] >= 1.0


def test_rapids_alone_bound_no_feed(machine: Machine) -> None:
    slow = replace(machine, axes=tuple(replace(axis, velocity=150.0) for axis in machine.axes))
    plan = planned("F600\nG0 X60 Y50\nG1 X61\nG0 X0 Y0", slow)
    assert room_on(plan, *UNO) == room_on(planned("F600\nG1 X1", slow), *UNO)


def test_planned_anew_the_room_is_at_least_as_great_and_its_own_plan_passes(machine: Machine) -> None:
    plan = planned(LINE.format(8000), machine)
    least = room_on(plan, *UNO).most
    most = most_feed(plan, *UNO, least)
    assert 1.0 <= least <= most < 2.0
    assert room_on(planned(LINE.format(8000 * most), machine), *UNO).problem is None


def test_a_machine_that_is_none_for_the_board_is_told_so() -> None:
    room = room_on(trochia.plan(trochia.gcode("G21 G1 X1 F600\nM2\n"), trochia.load("xy-table")), *UNO)
    assert room.most == 0.0
    assert room.problem is not None
    assert "must be a stepper" in room.problem.message


def test_a_long_slow_motion_is_judged_much_faster_than_span_by_span(machine: Machine) -> None:
    plan = planned("F300\nG1 X200\nX0", machine)
    begin = time.process_time()
    board_problems(plan, *UNO)
    whole = time.process_time() - begin
    begin = time.process_time()
    room_on(plan, *UNO)
    assert time.process_time() - begin < 0.2 * whole
