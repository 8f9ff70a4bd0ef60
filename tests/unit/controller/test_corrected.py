"""A machine that errs and corrects it, under the controller: homed, run, recorded, gone on with."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.recording import Take
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.error_table import ErrorTable
from trochia.messages import command as c
from trochia.recorder import read

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine


@pytest.fixture
def corrected(homed_mill: Machine) -> Machine:
    joints = []
    for joint, axis in zip(homed_mill.joints, homed_mill.axes, strict=True):
        x = np.linspace(axis.minimum, axis.maximum, 17)
        table = ErrorTable(points=tuple(zip(x.tolist(), (0.03 * np.sin(x / 25)).tolist(), strict=True)))
        joints.append(replace(joint, screw_error=table, backlash=0.02,
                              compensation=Compensation(screw=table, backlash=0.02)))  # fmt: skip
    return replace(homed_mill, joints=tuple(joints), squareness=Squareness(XY=0.05),
                   squareness_error=Squareness(XY=0.05))  # fmt: skip


def test_it_is_homed_and_goes_where_it_is_told(bench, corrected: Machine) -> None:
    real = {axis.name: axis.minimum + 8.0 for axis in corrected.axes}
    made = bench(corrected, real=real).on()
    made.ok(c.Home())
    made.run(until="idle", most=400.0)
    assert all(axis.trusted for axis in made.status.axes)
    assert not made.status.alarms
    off = []
    for part in (0.05, 0.25, 0.1):
        goal = {axis.name: axis.minimum + part * (axis.maximum - axis.minimum) for axis in corrected.axes}
        made.ok(c.JogTo(position=goal))
        made.run(until="idle", most=200.0)
        report = made.runtime.controller.report
        assert made.runtime.controller.position() == pytest.approx(goal, abs=1e-5)
        off.append(report.actual - report.commanded)
    # homing finds a switch to some hundredths; what it is off by is the same everywhere
    assert np.abs(np.array(off)).max() < 0.1
    assert np.ptp(np.array(off), axis=0).max() < 0.012


def test_a_job_that_was_cut_is_gone_on_with_where_it_was(bench, corrected: Machine, tmp_path: Path) -> None:
    text = "G21 G90 G94 F1200\nG1 X40 Y20\nX5\nX50 Y50\nM2\n"
    made = bench(corrected, journal=tmp_path / "j").on()
    made.runtime.controller.trusted = dict.fromkeys(made.runtime.controller.trusted, True)
    made.ok(c.Load(name="p", text=text))
    made.ok(c.Run())
    made.run(2.5)
    before = made.runtime.controller.position()
    made.ok(c.Abort())
    made.run(until="idle")
    made.runtime.recorder.start(Take(path=tmp_path / "r"))
    made.ok(c.RunFrom(line=0, confirmed=True))
    made.run(until="idle")
    made.runtime.close()
    end = made.runtime.controller.position()
    assert (end["X"], end["Y"]) == (pytest.approx(50.0, abs=1e-5), pytest.approx(50.0, abs=1e-5))
    recorded = read(tmp_path / "r")
    nearest = np.hypot(recorded["X.commanded"] - before["X"], recorded["Y.commanded"] - before["Y"]).min()
    assert nearest < 3.0  # it braked behind that
    error = recorded["X.actual"] - recorded["X.commanded"]
    assert np.median(np.abs(error)) < 0.005
