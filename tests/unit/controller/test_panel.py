"""Door, interlock, the beam's key, the emergency stop, drives nobody uses: inputs that guard people."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from trochia.machine.io import Channel, Spindle
from trochia.machine.panel import Panel
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

LINE = "G21 G90 G94 M3 S1000\nG1 X40 F1200\nM2\n"
NAMES = ("gate", "lid", "button", "key")
PANEL = Panel(door="gate", interlock="lid", estop="button", idle_release=30.0)


def guarded(machine: Machine, panel: Panel = PANEL) -> Machine:
    return replace(machine, panel=panel, io=(*machine.io, *(Channel(name=name, kind="input") for name in NAMES)))


@pytest.fixture
def mill(mill: Machine) -> Machine:
    return replace(guarded(mill), spindle=Spindle(maximum=3000.0, spin_up=0.5))


def put(b, name: str, value: float) -> None:
    b.ok(c.SetInput(name=name, value=value))
    b.run(0.005)


def begin(b) -> None:
    b.ok(c.Load(name="p", text=LINE))
    b.ok(c.Run())
    b.run(1.5)  # half a second of it the spindle
    assert b.status.speed == pytest.approx(20.0, rel=0.01)


def test_an_open_door_holds_with_the_spindle_off_and_only_a_resume_goes_on(bench, mill: Machine) -> None:
    b = bench(mill).on()
    begin(b)
    put(b, "gate", 1)
    assert b.status.state == "holding"
    assert b.run(until="held").spindle == 0.0
    request = b.status.request
    assert request is not None
    assert "close it" in request.text
    answer = b.command(c.Resume())
    assert not answer.ok
    assert "door is open" in answer.reason
    put(b, "gate", 0)
    here = b.at("X")
    assert b.run(1.0).state == "held"
    b.ok(c.Resume())
    assert b.run(0.4).axes[0].commanded == here  # the spindle gets to its speed first
    assert b.status.spindle == 1000.0
    assert b.run(until="idle").axes[0].commanded == pytest.approx(40.0, abs=1e-9)


def test_a_hold_while_the_spindle_gets_to_speed_stays(bench, mill: Machine) -> None:
    b = bench(mill).on()
    begin(b)
    put(b, "gate", 1)
    b.run(until="held")
    put(b, "gate", 0)
    b.ok(c.Resume())
    b.run(0.1)
    b.ok(c.Hold())
    here = b.run(until="held").axes[0].commanded
    assert b.run(1.0).axes[0].commanded == here
    b.ok(c.Resume())
    assert b.run(until="idle").axes[0].commanded == pytest.approx(40.0, abs=1e-9)


@pytest.mark.parametrize("command", [c.Run(), c.Mdi(text="G0 X1"), c.Step(), c.RunFrom(line=2, confirmed=True)])
def test_with_the_door_open_no_program_begins_and_axes_jog(bench, mill: Machine, command: c.AnyCommand) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text=LINE))
    put(b, "gate", 1)
    answer = b.command(command)
    assert not answer.ok
    assert "door is open" in answer.reason
    b.ok(c.JogBy(way={"X": 2.0}))
    assert b.run(until="idle").axes[0].commanded == pytest.approx(2.0)


def test_a_broken_interlock_brakes_and_gives_up_and_comes_back_until_it_is_closed(bench, mill: Machine) -> None:
    b = bench(mill).on()
    begin(b)
    put(b, "lid", 1)
    status = b.run(0.5)
    assert status.state == "alarm"
    assert "interlock lid" in status.alarms[0].message
    assert 0.0 < b.at("X") < 40.0
    assert status.spindle == 0.0
    b.ok(c.Acknowledge())
    assert b.run(0.1).state == "alarm"
    put(b, "lid", 0)
    b.ok(c.Acknowledge())
    assert b.run(0.1).state == "idle"
    assert all(axis.trusted for axis in b.status.axes)  # it braked along its path


def test_the_button_stops_all_and_is_released_before_a_reset(bench, mill: Machine) -> None:
    b = bench(mill).on()
    begin(b)
    put(b, "button", 1)
    status = b.run(0.01)
    assert status.state == "estop"
    assert not any(axis.enabled for axis in status.axes)
    assert "pressed" in b.command(c.Reset()).reason
    put(b, "button", 0)
    b.ok(c.Reset())
    put(b, "button", 1)
    assert b.status.state == "estop"


def test_drives_are_not_switched_on_with_the_interlock_broken(bench, mill: Machine) -> None:
    b = bench(mill)
    put(b, "lid", 1)
    assert "interlock" in b.command(c.Enable()).reason


def test_drives_go_off_when_nobody_asks_for_anything(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.run(25.0)
    b.ok(c.SetOutput(name="lamp", value=1.0))
    assert b.run(25.0).state == "idle"
    assert b.run(6.0).state == "off"
    assert not b.status.axes[0].enabled


def test_without_the_key_the_beam_stays_dark_and_turned_off_it_holds(bench, laser: Machine) -> None:
    b = bench(guarded(laser, Panel(arm="key", door="gate"))).on()
    assert "key is off" in b.ok(c.ArmBeam(on=True)).told
    assert not b.status.armed
    b.ok(c.Load(name="p", text="G21 G90 G94 M3 S80\nG1 X40 F1200\nM2\n"))
    assert "key is off" in b.command(c.Run()).reason
    put(b, "key", 1)
    assert b.status.armed
    b.ok(c.Run())
    b.run(1.0)
    assert b.status.beam == 80.0
    out = b.at("X")
    put(b, "key", 0)
    b.run(0.005)
    assert b.run(until="held").beam == 0.0
    assert "key is off" in b.command(c.Resume()).reason
    put(b, "key", 1)
    since = len(b.trace)
    b.ok(c.Resume())
    b.run(until="idle")
    lit = next(position[0] for _, position, beam, _ in b.trace[since:] if beam)
    assert lit == pytest.approx(out, abs=0.25)  # a turn or two at 20 mm/s
    assert b.at("X") == pytest.approx(40.0, abs=1e-6)


def test_a_beam_is_dark_from_the_door_on(bench, laser: Machine) -> None:
    b = bench(guarded(laser, Panel(door="gate"))).on()
    b.ok(c.ArmBeam(on=True))
    b.ok(c.Load(name="p", text="G21 G90 G94 M3 S80\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(1.0)
    put(b, "gate", 1)
    b.run(0.005)
    assert b.status.beam == 0.0
    assert not b.status.armed
    since = len(b.trace)
    b.run(until="held")
    assert not any(beam for _, _, beam, _ in b.trace[since:])


LOW = "G21 G90 G94 M3 S1000\nG1 Z-20 F1200\nG1 X40 F1200\nM2\n"


@pytest.fixture
def lifted(mill: Machine) -> Machine:
    return replace(mill, panel=replace(PANEL, retract=15.0))


def open_inside(b) -> tuple[float, float]:
    """Open the door in the middle of X, and return where the job rests."""
    b.ok(c.Load(name="p", text=LOW))
    b.ok(c.Run())
    b.run(2.4)
    assert 0.0 < b.at("X") < 40.0
    put(b, "gate", 1)
    b.run(until="retracting")
    return b.at("X"), b.at("Z")


def test_the_tool_goes_up_and_comes_back_before_the_job_goes_on(bench, lifted: Machine) -> None:
    b = bench(lifted).on()
    x, z = open_inside(b)
    assert z == pytest.approx(-20.0, abs=0.01)
    b.run(until="held")
    assert (b.at("X"), b.at("Z")) == pytest.approx((x, z + 15.0), abs=1e-6)
    held = b.status.program
    assert held is not None
    put(b, "gate", 0)
    b.ok(c.Resume())
    since = len(b.trace)
    b.run(0.02)
    b.run(until="running")
    back = [position for _, position, *_ in b.trace[since:]]
    assert min(row[2] for row in back) == pytest.approx(z, abs=1e-6)
    assert all(row[0] == pytest.approx(x, abs=0.5) for row in back)
    b.run(until="idle")
    assert (b.at("X"), b.at("Z")) == pytest.approx((40.0, -20.0), abs=1e-9)
    assert not b.status.alarms


def test_the_door_again_on_the_way_back(bench, lifted: Machine) -> None:
    b = bench(lifted).on()
    x, _ = open_inside(b)
    b.run(until="held")
    put(b, "gate", 0)
    b.ok(c.Resume())
    b.run(0.6)  # half a second of it the spindle
    put(b, "gate", 1)
    status = b.run(until="held")
    assert status.spindle == 0.0
    assert b.at("X") == pytest.approx(x, abs=1e-6)
    assert -20.0 < b.at("Z") < -4.0
    put(b, "gate", 0)
    b.ok(c.Resume())
    b.run(0.02)
    b.run(until="idle")
    assert (b.at("X"), b.at("Z")) == pytest.approx((40.0, -20.0), abs=1e-9)


@pytest.mark.parametrize("when", ["retracting", "held"])
def test_a_job_given_up_with_its_tool_away_can_be_gone_on_with_where_it_was(bench, lifted: Machine, when: str) -> None:
    b = bench(lifted).on()
    x, z = open_inside(b)
    if when == "held":
        b.run(until="held")
    b.ok(c.Abort())
    b.run(until="idle")
    job = b.runtime.controller.interrupted
    assert job is not None
    assert (job.position["X"], job.position["Z"]) == pytest.approx((x, z), abs=1e-6)
    put(b, "gate", 0)
    b.ok(c.RunFrom(line=0, confirmed=True))
    b.run(0.02)
    b.run(until="idle")
    assert (b.at("X"), b.at("Z")) == pytest.approx((40.0, -20.0), abs=1e-9)


def test_the_button_with_the_tool_on_its_way_up(bench, lifted: Machine) -> None:
    b = bench(lifted).on()
    open_inside(b)
    put(b, "button", 1)
    assert b.run(0.02).state == "estop"
    assert b.runtime.controller.away is None
    put(b, "button", 0)
    put(b, "gate", 0)
    b.ok(c.Reset())
    b.on()
    assert b.status.state == "idle"
