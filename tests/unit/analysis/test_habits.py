"""Warnings about programs that are legal and yet wrong."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from trochia import api
from trochia.analysis.habits import warnings
from trochia.machine.axes import Axis, AxisKind, PathLimits
from trochia.machine.io import Beam
from trochia.machine.io import Spindle as SpindleMotor
from trochia.machine.joints import Joint, Servo
from trochia.machine.kinematics import Cartesian
from trochia.machine.machine import Machine
from trochia.machine.transmissions import Leadscrew
from trochia.program import MOVE, Action, Dwell, End, MoveKind, Program, Spindle


def machine(*, beam: Beam | None = None, spindle: SpindleMotor | None = None) -> Machine:
    axes = tuple(
        Axis(name=n, kind=AxisKind.LINEAR, minimum=-100, maximum=100, velocity=100, acceleration=500) for n in "XYZ"
    )
    joints = tuple(Joint(name=n, motor=Servo(), transmission=Leadscrew(lead=Fraction(2))) for n in "XYZ")
    return Machine(name="m", description="", axes=axes, joints=joints, kinematics=Cartesian((0, 1, 2), 3),
                   path=PathLimits(), beam=beam, spindle=spindle)  # fmt: skip


def program(*moves: tuple[MoveKind, tuple[float, float, float], float], actions: tuple[Action, ...] = ()) -> Program:
    rows = np.zeros(len(moves), MOVE)
    for row, (kind, target, power) in zip(rows, moves, strict=True):
        row["kind"], row["power"] = kind, power
        row["target"][:3] = target
    rows["line"] = np.arange(1, len(moves) + 1)
    return Program(name="p.ngc", lines=len(moves), start=np.zeros(9), moves=rows, actions=actions)


R, F, A = MoveKind.RAPID, MoveKind.FEED, MoveKind.ARC
BEAM, SPINDLE = Beam(kind="shutter"), SpindleMotor(maximum=10000)


def codes(part: Program, on: Machine) -> list[tuple[str, int]]:
    return [(w.code, w.line) for w in warnings(part, on)]


def test_feed_with_the_tool_off_names_first_line_and_count():
    part = program((R, (1, 0, 0), 0), (F, (2, 0, 0), 0), (F, (2, 0, 0), 0), (A, (2, 0, 0), 0))
    (warning,) = warnings(part, machine(spindle=SPINDLE))
    assert (warning.code, warning.line) == ("tool-off", 2)
    assert (
        warning.message == "feed with the spindle off (and on 1 more line)"
    )  # the zero-length move counts for nothing


def test_a_plotter_has_nothing_to_switch_on():
    assert codes(program((F, (2, 0, 0), 0)), machine()) == []


def test_beam_in_a_rapid():
    part = program((F, (2, 0, 0), 1), (R, (0, 0, 0), 1))
    assert codes(part, machine(beam=BEAM)) == [("beam-in-rapid", 2)]
    assert codes(part, machine(spindle=SPINDLE)) == []  # a spindle runs in rapids: that is no mistake


@pytest.mark.parametrize(("seconds", "expected"), [(0.5, [("beam-at-rest", 7)]), (0.0, [])])
def test_beam_at_rest(seconds: float, expected: list[tuple[str, int]]):
    actions = (
        Dwell(at=0, line=1, seconds=1),
        Spindle(at=0, line=2, direction=1, speed=0),
        Dwell(at=1, line=7, seconds=seconds),
        Spindle(at=1, line=8, direction=0, speed=0),
        Dwell(at=1, line=9, seconds=1),
        End(at=1, line=10),
    )
    assert codes(program((F, (2, 0, 0), 1), actions=actions), machine(beam=BEAM)) == expected


def test_a_rapid_below_the_lowest_cut():
    part = program((F, (0, 0, -2), 1), (R, (5, 0, -2), 1), (R, (5, 0, -3), 1), (R, (9, 0, -3), 1), (R, (9, 0, 5), 1))
    assert codes(part, machine(spindle=SPINDLE)) == [("rapid-below-cut", 4)]


def test_a_thread_faster_than_its_axis_is_an_error():
    text = "G95 F0.1\nS3000 M3\nG0 X10\nG33 Z-20 K2\nG0 X12\nM2\n"
    lathe = api.load("lathe")
    fine = api.check(text.replace("S3000", "S100"), lathe)
    assert fine.ok, fine.problems
    found = api.check(text, lathe)
    assert not found.ok
    assert [(p.code, p.line) for p in found.problems if p.severity.value == "error"] == [("lock-too-fast", 4)]
