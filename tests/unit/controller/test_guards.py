"""Limit switches, warnings, and axes that run away."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.guards import Guards, homes_to
from trochia.machine.homing import LimitSwitch
from trochia.machine.io import Channel
from trochia.machine.joints import Encoder
from trochia.messages import Cause
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine


@pytest.fixture
def fenced(mill: Machine) -> Machine:
    x = replace(mill.axes[0], limit_plus=LimitSwitch(input="end", at=20.0))
    return replace(mill, axes=(x, *mill.axes[1:]), io=(*mill.io, Channel(name="end", kind="input")))


def test_running_onto_a_limit_switch_stops_at_once_and_names_it(bench, fenced: Machine) -> None:
    b = bench(fenced).on()
    b.ok(c.Load(name="p", text="G21 G90 G94 G1 X60 F1200\nM2\n"))
    b.ok(c.Run())
    status = b.run(until="alarm")
    (alarm,) = status.alarms
    assert alarm.cause is Cause.HARD_LIMIT
    assert (alarm.axis, alarm.limit, alarm.unit) == ("X", 20.0, "mm")
    assert 20.0 <= b.run(0.1).axes[0].commanded <= 20.0 + 20.0 * 0.011
    b.ok(c.Acknowledge())
    b.run(until="idle")
    answer = b.command(c.JogBy(way={"X": 1.0}))
    assert not answer.ok
    assert "limit switch end" in answer.reason
    b.ok(c.JogBy(way={"X": -5.0}))  # away from it
    assert b.run(until="idle").axes[0].commanded < 16.0


def test_a_switch_that_an_axis_is_homed_to_is_no_limit_while_it_is(bench, homed_mill: Machine) -> None:
    x = homed_mill.axes[0]
    assert x.home is not None
    x = replace(x, home=replace(x.home, method="limit", input=None, position=x.minimum - 2.0))
    machine = replace(homed_mill, axes=(x, *homed_mill.axes[1:]))
    assert homes_to(x, "limit-X")
    b = bench(machine, real={axis.name: axis.minimum + 10.0 for axis in machine.axes}).on()
    b.ok(c.Home(axes=("X",)))
    status = b.run(until="idle")
    assert status.axes[0].trusted
    assert not status.alarms


def test_a_lag_is_warned_of_before_it_is_a_fault_and_stops_nothing(bench, mill: Machine) -> None:
    joints = (replace(mill.joints[0], following_warning=0.2, following_error=3.0), *mill.joints[1:])
    b = bench(replace(mill, joints=joints)).on()
    b.ok(c.Load(name="p", text="G21 G90 G94 G1 X10 F600\nM2\n"))
    b.ok(c.Run())
    b.run(0.3)
    b.twin.plant.jammed.add("X")
    b.run(0.06)
    (alarm,) = b.status.alarms
    assert alarm.warning
    assert b.status.state == "running"
    b.twin.plant.jammed.clear()
    b.run(until="idle")


def test_an_encoder_that_runs_away_is_over_speed(bench, mill: Machine) -> None:
    joints = tuple(replace(joint, encoder=Encoder(counts=2000)) for joint in mill.joints)
    machine = replace(mill, joints=joints)
    b = bench(machine).on()
    report = b.runtime.controller.report
    guards = Guards(machine)
    assert list(guards.troubles(report, homing=False)) == []
    run = replace(report, time=report.time + 0.02, encoder=report.encoder + np.array([0.02 * 300.0, 0.1, 0.0]))
    (trouble,) = guards.troubles(run, homing=False)
    assert trouble.cause is Cause.OVER_SPEED
    assert trouble.joint == "X"
    assert trouble.value == pytest.approx(300.0)
