"""The tool that finds least times with limited jerk, on moves whose least time is known; and plans against it."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import plan
from trochia.planner.limits import Limits
from trochia.toolpath import build

pytestmark = pytest.mark.oracle

third_order = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "third_order.py"))["third_order"]


def planned(text):
    machine = load("reference-mill")
    program = gcode.read(f"F60000\n{text}\nM2\n")
    return plan(build(program, machine, continuity=2), machine, program=program, profile="s-curve"), Limits.of(machine)


@pytest.mark.parametrize("text", ["G1 X0.3", "G1 X20 Y10 Z3", "G61.1\nG1 X10\nY10"])
def test_moves_from_rest_to_rest_take_the_seven_phases(text):
    trajectory, limits = planned(text)
    assert third_order(trajectory.path, limits, trajectory, 0.5) == pytest.approx(trajectory.times["motion"], rel=3e-3)


@pytest.mark.parametrize("text", ["G3 X0 Y0 I10", "G64 P0.01\nG1 X30\nG3 X30 Y8 J4\nG1 X0"])
def test_bends_are_passed_in_little_more_than_the_least_time(text):
    trajectory, limits = planned(text)
    least = third_order(trajectory.path, limits, trajectory, 0.5)
    assert 0.997 * least <= trajectory.times["motion"] <= 1.12 * least
