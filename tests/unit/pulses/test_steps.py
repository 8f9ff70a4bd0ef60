"""Step blocks: windows of time over all joints, counts carried from one to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.languages import gcode
from trochia.machine.joints import Servo
from trochia.machine.load import load
from trochia.planner import plan
from trochia.pulses import CLOCK, step_blocks
from trochia.pulses.steps import WINDOW, step_rows
from trochia.toolpath import build

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

Maker = Callable[..., Any]

PROGRAM = """G21 G90 G64 P0.05 F1200
G0 X10 Y10
G1 X30 Y12
G1 X31 Y30
G2 X11 Y10 I-10 J-10
G61 G3 X11 Y10 I5 J0
G4 P0.25
G1 X10.003 Y9.998
M2
"""


def test_steps_are_those_of_each_joint(laser: Machine, line_motion: Maker) -> None:
    """3:4:5 at 5 mm/s for 2 s: 6 mm and 8 mm at 50 steps a mm, evenly."""
    blocks = list(step_blocks(line_motion([0.0, 0.0], [0.6, -0.8], [(0, 2.0, 0, 5.0, 0, 0)]), laser))
    x, y = (np.concatenate([block.ticks[joint] for block in blocks]) for joint in (0, 1))
    assert x.tolist() == [round(CLOCK * k / 150) for k in range(1, 301)]
    assert y.tolist() == [round(CLOCK * k / 200) for k in range(1, 401)]
    assert all((block.directions[1] == -1).all() for block in blocks)


def test_windows_follow_each_other_without_a_gap(laser: Machine, line_motion: Maker) -> None:
    motion = line_motion([1.0, 2.0], [1.0, 0.0], [(0, 0.33, 0, 3.0, 0, 0)], [(0.33, 0.5, 0.99, 3.0, 0, 0)])
    blocks = list(step_blocks(motion, laser))
    assert blocks[0].start == 0
    assert blocks[-1].end == round(0.83 * CLOCK)
    assert all(before.end == after.start for before, after in pairwise(blocks))
    assert max(block.end - block.start for block in blocks) <= WINDOW * CLOCK + 1
    counts = [block.counts for block in blocks]
    assert counts[0] == (50, 100)
    for block, after in zip(blocks, counts[1:], strict=False):
        assert tuple(c + int(d.sum()) for c, d in zip(block.counts, block.directions, strict=True)) == after
        assert all(((t >= block.start) & (t <= block.end)).all() for t in block.ticks)


def test_an_arbitrary_start_counts_from_the_nearest_step(laser: Machine, line_motion: Maker) -> None:
    """From 1.013 mm = 50.65 steps: the count is 51, and the first step up is number 52."""
    motion = line_motion([1.013, 0.0], [1.0, 0.0], [(0, 1.0, 0, 1.0, 0, 0)])
    blocks = list(step_blocks(motion, laser))
    assert blocks[0].counts == (51, 0)
    assert blocks[0].ticks[0][0] == round(CLOCK * (52 / 50 - 1.013))


def test_given_counts_are_caught_up_at_once(laser: Machine, line_motion: Maker) -> None:
    motion = line_motion([0.0, 0.0], [1.0, 0.0], [(0, 0.05, 0, 1.0, 0, 0)])
    block = next(iter(step_blocks(motion, laser, counts=(1, 0))))
    assert block.ticks[0].tolist() == [round(CLOCK * 2 / 50)]


def test_a_servo_joint_gets_no_steps(laser: Machine, line_motion: Maker) -> None:
    servo = replace(laser.joints[1], motor=Servo())
    machine = replace(laser, joints=(laser.joints[0], servo))
    assert step_rows(machine).tolist() == [[50.0, 0.0], [0.0, 0.0]]
    blocks = list(step_blocks(line_motion([0.0, 0.0], [0.6, 0.8], [(0, 1.0, 0, 5.0, 0, 0)]), machine))
    assert sum(block.ticks[0].size for block in blocks) == 150
    assert sum(block.ticks[1].size for block in blocks) == 0


@pytest.mark.parametrize("name", ["laser", "corexy", "reference-mill", "router"])
@pytest.mark.parametrize("clock", [CLOCK, 1_000_000])
def test_a_planned_program_arrives_on_the_step(name: str, clock: int) -> None:
    """At every instant the count is less than a step from the planned position, at the end and in between."""
    machine = load(name)
    program = gcode.read(PROGRAM, axes="".join(axis.name for axis in machine.axes))
    motion = plan(build(program, machine), machine, program=program)
    blocks = list(step_blocks(motion, machine, clock=clock))
    times = np.linspace(0, motion.duration, 5001)
    wanted = motion.position(times) @ step_rows(machine).T
    for joint in range(len(machine.joints)):
        ticks = np.concatenate([block.ticks[joint] for block in blocks])
        ways = np.concatenate([block.directions[joint] for block in blocks])
        counts = blocks[0].counts[joint] + np.concatenate(([0], np.cumsum(ways, dtype=np.int64)))
        assert (np.diff(ticks) > 0).all()
        # half a tick of rounding lets the count be late or early by the way made in it
        slack = 1e-6 + 0.5 / clock * 1e5
        assert np.abs(wanted[:, joint] - counts[np.searchsorted(ticks / clock, times)]).max() < 1 + slack


def test_a_program_without_motion_has_empty_blocks(laser: Machine) -> None:
    program = gcode.read("G4 P0.35\nM2\n", axes="XY")
    blocks = list(step_blocks(plan(build(program, laser), laser, program=program), laser))
    assert blocks[-1].end == round(0.35 * CLOCK)
    assert not any(ticks.size for block in blocks for ticks in block.ticks)


def test_a_clock_below_one_tick_is_refused(laser: Machine, line_motion: Maker) -> None:
    with pytest.raises(ConfigError, match="clock"):
        list(step_blocks(line_motion([0.0, 0.0], [1.0, 0.0], []), laser, clock=0))
