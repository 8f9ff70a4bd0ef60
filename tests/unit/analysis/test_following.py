"""Servo joints that fall behind: torque by closed forms before a run, lag by what the run shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.check import judge
from trochia.analysis.following import servo_use
from trochia.analysis.plan import make
from trochia.analysis.problems import Severity
from trochia.analysis.prove import prove
from trochia.languages import gcode
from trochia.machine.load import load
from trochia.machine.servos.drive import servo_drive

TEXT = b"G21 G90 G64 P0.01\nF2000\nG1 X20 Y10\nG1 X0 Y30\nM2\n"


def planned(machine):
    return make(gcode.read(TEXT.decode(), name="part.ngc"), machine)


def test_torque_used_is_that_of_the_greatest_acceleration():
    """Acceleration and velocity limits give a bound; the plan reaches both at once somewhere near."""
    table = load("xy-table")
    use, drive = servo_use(planned(table))["X"], servo_drive(table, 0)
    assert drive is not None
    most = -float(drive.needed(np.array(-40.0), np.array(-133.0)))  # the amplifier's offset pushes the other way
    there = drive.plant.torque_constant * 11.5
    assert 0.5 * most / there < use.used <= 1.001 * most / there
    assert use.effective < drive.current


def test_a_weak_motor_is_warned_of_with_its_first_line():
    table = load("xy-table")
    weak = replace(table, joints=tuple(
        replace(joint, amplifier=replace(joint.amplifier, current=0.15)) for joint in table.joints))  # fmt: skip
    verdict = judge(planned(weak))
    short = [problem for problem in verdict.problems if problem.code == "torque-short"]
    assert {problem.line for problem in short} == {3}
    assert "of the acceleration would do" in (short[0].hint or "")
    assert verdict.figures()["margins"]["X"]["torque"] < 0


def test_a_lag_beyond_the_joints_stops_it_at_its_line(tmp_path):
    """Without velocity feed-forward the lag is 39 ms: 1.3 mm at 33 mm/s, beyond the 2000 counts of 0.49 mm."""
    table = load("xy-table")
    late = replace(table, joints=tuple(
        replace(joint, loop=replace(joint.loop, i32=0, i35=0)) for joint in table.joints))  # fmt: skip
    proof = prove(judge(planned(late)), TEXT, tmp_path)
    found = [problem for problem in proof.verdict.problems if problem.code == "following-error"]
    assert found
    assert found[0].severity is Severity.ERROR
    assert found[0].line == 3
    assert not proof.figures()["ok"]
    # velocity of X is at most 2000/60 mm/s · 2/√5
    peak = proof.following_error["X"].peak
    assert peak == pytest.approx(11280 * 442e-6 / 128 * 2000 / 60 * 2 / np.sqrt(5), rel=0.05)


def test_the_shipped_table_follows_within_its_warning(tmp_path):
    proof = prove(judge(planned(load("xy-table"))), TEXT, tmp_path)
    assert proof.verdict.ok
    assert not [problem for problem in proof.verdict.problems if problem.code.startswith("following")]
