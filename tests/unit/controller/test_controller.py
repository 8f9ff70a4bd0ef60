"""The controller on the twin, in virtual time: what a machinist relies on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.journal import entries
from trochia.machine.homing import Homing
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

SQUARE = "G21 G90 G94 F3000\nG1 X20\nY20\nX0\nY0\nM2\n"


def test_nothing_moves_at_power_up_and_what_needs_power_is_refused_with_what_is_legal(bench, mill: Machine) -> None:
    b = bench(mill)
    status = b.run(0.5)
    assert status.state == "off"
    assert not any(axis.enabled or axis.velocity for axis in status.axes)
    for command in (c.Run(), c.Jog(axis="X", speed=5.0), c.Mdi(text="G0 X1"), c.Home(), c.Step()):
        answer = b.command(command)
        assert not answer.ok
        assert "off" in answer.reason
        assert "enable" in answer.legal
    assert b.run(0.2).axes[0].commanded == 0.0


def test_a_program_runs_to_its_end(bench, mill: Machine) -> None:
    b = bench(mill).on()
    told = b.ok(c.Load(name="square", text=SQUARE)).told
    assert "s" in told
    b.ok(c.Run())
    assert b.run(0.3).state == "running"
    status = b.run(until="idle")
    assert [axis.commanded for axis in status.axes] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    corners = {tuple(np.round(position[:2])) for _, position, _, _ in b.trace}
    assert {(20.0, 0.0), (20.0, 20.0), (0.0, 20.0)} <= corners
    assert not status.alarms


@pytest.mark.parametrize("after", [0.05, 0.31, 0.62, 0.93, 1.27])
def test_hold_and_resume_stay_on_the_path_and_end_at_the_same_point(bench, mill: Machine, after: float) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="square", text=SQUARE))
    b.ok(c.Run())
    b.run(after)
    b.ok(c.Hold())
    held = b.run(until="held")
    assert held.speed == 0.0
    b.run(0.3)
    b.ok(c.Resume())
    status = b.run(until="idle")
    assert [axis.commanded for axis in status.axes] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    for _, (x, y, z), _, _ in b.trace:
        off = min(max(0 - x, x - 20, 0 - y, y - 20, -min(x, 20 - x, y, 20 - y)), abs(z) + 1e9)
        assert abs(off) < 0.011 or min(abs(x), abs(x - 20), abs(y), abs(y - 20)) < 0.011


def test_a_beam_is_dark_from_the_hold_and_lit_again_where_it_went_out(bench, laser: Machine) -> None:
    b = bench(laser).on()
    b.ok(c.ArmBeam(on=True))
    b.ok(c.Load(name="line", text="G21 G90 M3 S80\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(1.0)
    assert b.status.beam == 80.0
    out = b.at("X")
    b.ok(c.Hold())
    b.run(0.02)
    assert b.status.beam == 0.0
    b.run(until="held")
    stopped = b.at("X")
    assert stopped > out
    b.ok(c.Resume())
    b.run(until="idle")
    lit = [(t, position[0]) for t, position, beam, _ in b.trace if beam > 0.0]
    times, places = np.array(lit).T
    gap = int(np.argmax(np.diff(times)))
    assert places[gap + 1] - places[gap] == pytest.approx(0.0, abs=2 * 20.0 * 0.005)  # two turns at 20 mm/s
    assert min(position[0] for t, position, _, _ in b.trace if t > times[gap] + 0.5 and t < times[gap + 1]) < out


def test_abort_brakes_and_ends_the_job_with_the_spindle_off(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="x", text="G21 M3 S1000\nG1 X50 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(6.0 if mill.spindle is None else mill.spindle.spin_up + 0.8)
    assert b.status.spindle == 1000.0
    b.ok(c.Abort())
    assert b.status.state == "stopping"
    status = b.run(until="idle")
    b.run(0.02)
    assert b.status.spindle == 0.0
    assert 0.0 < status.axes[0].commanded < 50.0


def test_the_emergency_stop_is_at_once_and_positions_are_lost(bench, homed_mill: Machine) -> None:
    b = bench(homed_mill, real={axis.name: axis.minimum + 10.0 for axis in homed_mill.axes}).on()
    b.ok(c.Home())
    b.run(until="idle")
    b.ok(c.Load(name="square", text="G53 G1 X-440 F3000\nM2\n"))
    b.ok(c.Run())
    b.run(0.4)
    before = b.at("X")
    b.ok(c.EmergencyStop())
    status = b.run(0.05)
    assert status.state == "estop"
    assert b.at("X") - before <= 50 * 0.011
    assert not any(axis.trusted or axis.enabled for axis in status.axes)
    assert "estop" in status.legal
    b.ok(c.Reset())
    b.on()
    refused = b.command(c.Run())
    assert not refused.ok
    assert "Home first" in refused.reason


def test_a_jog_lives_by_its_lease(bench, mill: Machine) -> None:
    b = bench(mill).on()
    for _ in range(6):
        b.ok(c.Jog(axis="X", speed=20.0))
        b.run(0.1)
    assert b.status.state == "jogging"
    silent = b.now
    b.run(until="idle")
    assert b.status.axes[0].velocity == 0.0
    speeds = [(t, s.axes[0].velocity) for t, _, _, s in b.trace]
    falling = next(t for t, v in speeds if t > silent and v < 20.0 - 1e-6)
    assert falling - silent <= 0.15 + 0.02 + 0.006  # lease, status period, a turn


def test_a_jog_stops_short_of_the_end_of_travel(bench, mill: Machine) -> None:
    b = bench(mill).on()
    top = mill.axes[2].maximum
    while b.status.state in {"idle", "jogging"} and b.at("Z") < top - 1e-6:
        b.ok(c.Jog(axis="Z", speed=90.0))
        b.run(0.1)
    b.run(until="idle")
    assert b.at("Z") == pytest.approx(top, abs=1e-6)
    answer = b.command(c.Jog(axis="Z", speed=5.0))
    assert not answer.ok
    assert "end of its travel" in answer.reason


def test_jogs_by_a_way_and_to_a_place(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.JogBy(way={"X": 3.0, "Y": -1.0}))
    b.run(until="idle")
    b.ok(c.JogTo(position={"X": 1.0}, speed=2.0))
    b.run(until="idle")
    assert (b.at("X"), b.at("Y")) == pytest.approx((1.0, -1.0), abs=1e-9)
    assert not b.command(c.JogTo(position={"X": 1e6})).ok
    assert not b.command(c.JogBy(way={"A": 1.0})).ok


def test_homing_finds_the_switches_and_names_the_place(bench, homed_mill: Machine) -> None:
    low = {axis.name: axis.minimum for axis in homed_mill.axes}
    b = bench(homed_mill, real={name: at + 30.0 for name, at in low.items()}).on()
    b.ok(c.Home())
    status = b.run(until="idle")
    assert all(axis.trusted for axis in status.axes)
    for axis in status.axes:
        assert axis.commanded == pytest.approx(low[axis.name] + 5.0, abs=1e-6)
        # where the machine really is: the controller's figure, within what the slow approach does in a tick or two
        real = b.twin.plant.load[[a.name for a in homed_mill.axes].index(axis.name)]
        assert real == pytest.approx(axis.commanded, abs=0.02)


def test_homing_from_on_the_switch_drives_off_first(bench, homed_mill: Machine) -> None:
    low = {axis.name: axis.minimum for axis in homed_mill.axes}
    b = bench(homed_mill, real={name: at + 0.2 for name, at in low.items()}).on()
    b.ok(c.Home(axes=("X",)))
    status = b.run(until="idle")
    assert status.axes[0].trusted
    assert not status.axes[1].trusted
    assert min(position[0] for _, position, _, _ in b.trace[:40]) >= -1.0


def test_homing_without_a_switch_to_be_found_is_an_alarm(bench, homed_mill: Machine) -> None:
    x = replace(homed_mill.axes[0], minimum=-20.0, maximum=20.0, limit_minus=None, home=Homing(input="home-X"))
    b = bench(replace(homed_mill, axes=(x, *homed_mill.axes[1:]))).on()
    b.twin._switches.clear()
    b.ok(c.Home(axes=("X",)))
    status = b.run(until="alarm")
    assert "was not found" in status.alarms[0].message
    assert status.alarms[0].remedy
    b.ok(c.Acknowledge())
    b.run(until="idle")


def test_a_stuck_axis_is_stopped_at_its_following_error(bench, mill: Machine) -> None:
    joints = tuple(replace(joint, following_error=0.5) for joint in mill.joints)
    b = bench(replace(mill, joints=joints)).on()
    b.ok(c.Load(name="square", text=SQUARE))
    b.ok(c.Run())
    b.run(0.2)
    b.twin.plant.jammed.add("X")
    status = b.run(until="alarm")
    (alarm,) = status.alarms
    assert alarm.cause.value == "following-error"
    assert alarm.axis == "X"
    assert alarm.value is not None
    assert 0.5 < alarm.value < 0.6
    assert alarm.line
    assert not status.axes[0].trusted
    assert not b.run(0.02).axes[0].enabled
    assert not b.command(c.Enable()).ok
    b.twin.plant.jammed.clear()
    b.ok(c.Acknowledge())
    b.run(until="off")


def test_a_drive_fault_comes_back_until_it_is_gone(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.twin.faulty.add("Y")
    assert b.run(until="alarm").alarms[0].cause.value == "drive-fault"
    b.ok(c.Acknowledge())
    b.run(0.05)
    assert b.status.state == "alarm"
    b.twin.faulty.clear()
    b.ok(c.Acknowledge())
    b.run(until="off")


def test_mdi_begins_where_the_machine_is_and_keeps_what_it_sets(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Mdi(text="G10 L2 P2 X5"))
    b.run(until="idle")
    b.ok(c.Mdi(text="G55 G0 X1"))
    status = b.run(until="idle")
    assert status.axes[0].commanded == pytest.approx(6.0, abs=1e-9)
    assert not b.command(c.Mdi(text="G1 X5 F0")).ok
    assert not b.command(c.Mdi(text="G0 X1e5")).ok
    assert b.status.state == "idle"


def test_work_zero_makes_the_present_point_read_as_told(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.JogBy(way={"X": 7.0}))
    b.run(until="idle")
    b.ok(c.WorkZero(axes={"X": 2.0}))
    assert b.status.axes[0].work == pytest.approx(2.0)
    b.ok(c.Load(name="t", text="G90 G1 X3 F600\nM2\n"))
    b.ok(c.Run())
    assert b.run(until="idle").axes[0].commanded == pytest.approx(8.0, abs=1e-9)


def test_block_by_block_rests_at_the_end_of_each_line(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="square", text=SQUARE))
    b.ok(c.Step())
    seen = []
    for _ in range(3):
        status = b.run(until="held")
        seen.append((round(status.axes[0].commanded, 6), round(status.axes[1].commanded, 6)))
        b.ok(c.Step())
    assert seen == [(20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]
    b.run(until="idle")
    assert b.at("Y") == pytest.approx(0.0, abs=1e-9)


def test_stops_tool_changes_and_outputs_of_a_program(bench, mill: Machine) -> None:
    text = "G21 M64 P0\nG1 X5 F3000\nM0\nX10\nM1\nT3 M6\nX15\nM65 P0\nX20\nM2\n"
    b = bench(mill).on()
    b.ok(c.Load(name="t", text=text))
    b.ok(c.Run())
    status = b.run(until="held")
    assert status.axes[0].commanded == pytest.approx(5.0, abs=1e-6)
    assert status.request is not None
    assert status.io["lamp"] == 1.0
    b.ok(c.Resume())
    status = b.run(until="held")  # M1 does not stop; the tool change does
    assert status.axes[0].commanded == pytest.approx(10.0, abs=1e-6)
    assert status.request is not None
    assert status.request.kind == "tool"
    assert "tool 3" in status.request.text
    b.ok(c.Answer(request=status.request.number))
    status = b.run(until="idle", most=200.0)
    assert status.axes[0].commanded == pytest.approx(20.0, abs=1e-6)
    assert status.io["lamp"] == 0.0
    assert status.tool == 3
    lit = [position[0] for _, position, _, s in b.trace if s.io.get("lamp")]
    assert max(lit) == pytest.approx(15.0, abs=0.3)


def test_overrides_act_while_it_runs_and_the_end_is_the_same(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="t", text="G21 G90\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(0.6)
    assert b.status.speed == pytest.approx(20.0, rel=1e-3)
    b.ok(c.Override(feed=0.5))
    b.run(0.4)
    assert b.status.speed == pytest.approx(10.0, rel=1e-3)
    b.ok(c.Override(feed=2.0))
    b.run(0.5)
    assert b.status.speed == pytest.approx(40.0, rel=1e-3)
    assert b.run(until="idle").axes[0].commanded == pytest.approx(40.0, abs=1e-9)


def test_the_journal_tells_what_was_executed(bench, mill: Machine, tmp_path) -> None:
    b = bench(mill, journal=tmp_path).on()
    b.ok(c.Load(name="square", text=SQUARE))
    b.ok(c.Run())
    b.run(0.5)
    true = b.status
    kinds = list(entries(tmp_path))
    points = [entry for entry in kinds if entry["kind"] == "point"]
    assert true.time - points[-1]["time"] <= 0.02 + 1e-9
    assert points[-1]["line"] == true.program.line
    assert abs(points[-1]["position"]["X"] - true.axes[0].commanded) <= 50 * 0.02
    assert {"begin", "command", "state", "point"} <= {entry["kind"] for entry in kinds}


@pytest.mark.parametrize("command", [c.Hold(), c.Abort()])
def test_a_stop_before_the_first_tick_moves_nothing(bench, mill: Machine, command: c.AnyCommand) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="square", text=SQUARE))
    b.ok(c.Run())  # 0.2 s of motion are with the backend now
    b.ok(command)
    status = b.run(until="held" if isinstance(command, c.Hold) else "idle")
    assert b.run(0.3).axes[0].commanded == pytest.approx(0.0, abs=1e-3)
    if status.state == "held":
        b.ok(c.Resume())
        assert [axis.commanded for axis in b.run(until="idle").axes] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
        assert max(position[0] for _, position, _, _ in b.trace) == pytest.approx(20.0, abs=0.01)


@pytest.mark.parametrize("line", ["G38.2 Z-5 F100", "M66 P7 L3 Q1", "S100 M3\nG33 Z-5 K1"])
def test_what_cannot_be_run_live_is_refused_before_anything_moves(bench, mill: Machine, line: str) -> None:
    b = bench(mill).on()
    text = f"G21 G90\nG0 X5\n{line}\nM2\n"
    b.command(c.Load(name="t", text=text))
    answer = b.command(c.Run())
    assert not answer.ok
    b.run(0.3)
    assert b.status.state == "idle"
    assert b.at("X") == 0.0


def test_a_deep_queue_is_filled_turn_by_turn(bench, mill: Machine) -> None:
    b = bench(mill)
    b.twin.ahead = b.runtime.controller.ahead = 0.6
    b.on()
    b.ok(c.Load(name="p", text="G21 G90 G94\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    held = [b.run(0.005).queued_s for _ in range(20)]
    assert held[0] < 0.35  # what is needed soon, and two chunks
    assert max(held) >= 0.55
    b.ok(c.Hold())
    assert b.run(0.05).state in {"holding", "held"}  # it is replaced as soon as before
    b.run(until="held", most=0.5)
    b.ok(c.Resume())
    assert b.run(until="idle").axes[0].commanded == pytest.approx(40.0, abs=1e-9)
