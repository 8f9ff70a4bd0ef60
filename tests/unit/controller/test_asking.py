"""Programs that ask the machine: probing moves and M66, live."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from trochia.controller.interrupted import interrupted
from trochia.machine.io import Channel
from trochia.machine.panel import Panel
from trochia.machine.probe import Part, Probe
from trochia.messages import command as c

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine

TOP = -12.3456  #: of what the probe meets [mm]
STEP = 0.005  #: of the motors: nearer nothing moves [mm]
FAST = "G38.2 Z-40 F600\n"


@pytest.fixture
def probing(mill: Machine) -> Machine:
    io = (*mill.io, Channel(name="probe", kind="input"), Channel(name="volts", kind="analog-input"))
    return replace(mill, io=io, probe=Probe(input="probe", part=Part(left=20.0, top=TOP)))


def run(b, text: str, *, until: str = "idle"):
    b.ok(c.Load(name="p", text=text))
    b.ok(c.Run())
    return b.run(until=until)


def away(b, x: float = 30.0) -> None:
    b.ok(c.Mdi(text=f"G0 X{x}"))
    b.run(until="idle")


def test_a_probing_move_stops_at_contact_and_the_program_goes_on_by_what_it_found(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    run(b, f"G21 G90\n{FAST}#100=#5063\nG0 Z[#100 + 5]\nG0 X[#5061 - 2 + #5070]\nM2\n")
    assert b.at("Z") == pytest.approx(TOP + 5.0, abs=1e-3)  # 10 mm/s, and a step of 10 µm a tick: caught inside it
    assert b.at("X") == pytest.approx(29.0, abs=1e-6)
    states = [status.state for *_, status in b.trace]
    assert states.index("probing") < len(states) - 1
    deepest = min(row[1][2] for row in b.trace)
    assert TOP - 1.0 < deepest < TOP  # it takes a way to brake


def test_the_edge_is_caught_to_a_share_of_a_tick(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    found = []
    for feed in (60, 1200):
        run(b, f"G21 G90\nG0 Z0\nG38.2 Z-40 F{feed}\nG0 Z#5063\nM2\n")
        found.append(b.at("Z"))
    assert found == pytest.approx([TOP, TOP], abs=1.01 * STEP)


def test_inches_and_offsets_are_those_of_the_program(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    b.ok(c.WorkZero(axes={"X": 12.7, "Z": 5.0}))
    run(b, "G20 G90\nG38.2 Z-1 F20\nG21 G0 Z[#5063 * 25.4]\nG0 X[#5061 * 25.4]\nM2\n")
    assert b.at("Z") == pytest.approx(TOP, abs=STEP)
    assert b.at("X") == pytest.approx(30.0, abs=1e-6)


def test_a_second_touch_and_relative_moves_go_from_where_the_machine_stands(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    run(b, f"G21 G90\n{FAST}G91 G38.4 Z5 F60\n#1=#5063\nG0 Z3\nG38.2 Z-8 F60\nG90 G0 Z[#5063 + [#5063 - #1] + 1]\nM2\n")
    assert b.at("Z") == pytest.approx(TOP + 1.0, abs=3 * STEP)


@pytest.mark.parametrize(
    ("move", "why"),
    [("G38.2 Z-10 F600", "touched nothing"), ("G38.4 Z5 F600", "is clear already")],
)
def test_a_probing_move_that_must_and_does_not_is_an_alarm(bench, probing: Machine, move: str, why: str) -> None:
    b = bench(probing).on()
    away(b)
    run(b, f"G21 G90\n{move}\nG0 X0\nM2\n", until="alarm")
    alarm = b.status.alarms[0]
    assert alarm.cause.value == "probe"
    assert "line 2" in alarm.message
    assert why in alarm.message
    assert alarm.remedy
    b.run(0.1)
    assert b.at("X") == pytest.approx(30.0)
    b.ok(c.Acknowledge())
    b.run(until="idle")
    away(b, 0.0)


def test_a_probing_move_that_may_and_does_not_tells_the_program(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    text = "G21 G90\nG38.3 Z-10 F600\no1 if [#5070 EQ 0]\nG0 X1\no1 else\nG0 X2\no1 endif\nM2\n"
    run(b, text)
    assert (b.at("X"), b.at("Z")) == pytest.approx((1.0, -10.0))


def test_probing_by_hand_leaves_the_point_for_the_next_line(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    b.ok(c.Mdi(text="G38.2 Z-40 F600"))
    b.run(until="idle")
    b.ok(c.Mdi(text="G0 Z#5063\nG10 L20 P1 Z0"))
    b.run(until="idle")
    assert b.at("Z") == pytest.approx(TOP, abs=STEP)
    assert next(axis.work for axis in b.status.axes if axis.name == "Z") == pytest.approx(0.0, abs=1e-9)


def test_a_hold_gives_a_probing_move_up(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    b.ok(c.Load(name="p", text="G21 G90\nG38.2 Z-40 F60\nG0 X0\nM2\n"))
    b.ok(c.Run())
    b.run(until="probing")
    b.run(0.5)
    b.ok(c.Hold())
    assert b.run(until="idle").axes[0].commanded == pytest.approx(30.0)
    away(b, 0.0)


def test_without_a_probe_nothing_moves(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text="G21 G90\nG0 X5\nG38.2 Z-4 F60\nM2\n"))
    answer = b.command(c.Run())
    assert not answer.ok
    assert "line 3: the machine has no probe" in answer.reason
    assert b.at("X") == 0.0


def test_what_comes_after_a_question_is_refused_with_its_line(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    run(b, f"G21 G90\n{FAST}G0 X[#5063 * 1000]\nM2\n", until="alarm")
    alarm = b.status.alarms[0]
    assert alarm.cause.value == "program"
    assert "line 3" in alarm.message or ":3" in alarm.message


def test_a_job_cut_off_after_a_probe_goes_on_with_what_it_found(bench, probing: Machine, tmp_path: Path) -> None:
    b = bench(probing, journal=tmp_path).on()
    away(b)
    b.ok(c.Load(name="p", text=f"G21 G90\n{FAST}G1 Z[#5063 + 4] F600\nG1 X60 F1200\nG1 Y10\nM2\n"))
    b.ok(c.Run())
    b.run(until="probing")
    b.run(2.5)
    assert b.status.state == "running"
    b.run(0.5)
    here = b.at("X")
    assert 30.0 < here < 60.0
    job = interrupted(tmp_path)  # as if the process had been killed
    assert job is not None
    assert len(job.answers) == 1
    b.ok(c.Abort())
    b.run(until="idle")
    assert "line 4" in b.ok(c.RunFrom(line=0)).told
    b.ok(c.RunFrom(line=0, confirmed=True))
    b.run(until="idle")
    assert b.at("Z") == pytest.approx(TOP + 4.0, abs=STEP)
    assert (b.at("X"), b.at("Y")) == pytest.approx((60.0, 10.0))


def test_a_line_behind_a_question_is_not_run_from(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    b.ok(c.Load(name="p", text=f"G21 G90\nG1 Y1 F600\n{FAST}G1 X60 F600\nM2\n"))
    answer = b.command(c.RunFrom(line=4))
    assert not answer.ok
    assert "line 3" in answer.reason
    b.ok(c.RunFrom(line=2, confirmed=True))
    b.run(until="idle")
    assert (b.at("X"), b.at("Y")) == pytest.approx((60.0, 1.0))


def test_m66_reads_and_branches(bench, probing: Machine) -> None:
    text = "G21 G90\nG0 X1\nM66 P0 L0\nG0 Y[3 + #5399]\nM66 E0 L0\nG0 X#5399\nM2\n"
    b = bench(probing).on()
    b.ok(c.SetInput(name="volts", value=2.5))
    run(b, text)
    assert (b.at("X"), b.at("Y")) == pytest.approx((2.5, 3.0))
    b.ok(c.SetInput(name="door", value=1))
    run(b, text)
    assert b.at("Y") == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("way", "levels", "value"),
    [
        (1, (1, 0, 1), 1.0),
        (2, (0, 1, 0), 0.0),
        (3, (0, 1), 1.0),
        (4, (1, 0), 0.0),
        (3, (0, 0), -1.0),
        (1, (1, 1), -1.0),
    ],
)
def test_m66_waits_for_a_level_or_an_edge_and_not_for_ever(
    bench, probing: Machine, way: int, levels: tuple[int, ...], value: float
) -> None:
    b = bench(probing).on()
    b.ok(c.SetInput(name="door", value=levels[0]))
    b.ok(c.Load(name="p", text=f"G21 G90\nG0 X1\nM66 P0 L{way} Q2\nG0 Y[5 + #5399]\nM2\n"))
    b.ok(c.Run())
    b.run(0.6)
    for level in levels[1:]:
        assert b.at("Y") == 0.0
        b.ok(c.SetInput(name="door", value=level))
        b.run(0.3)
    begin = b.now
    b.run(until="idle")
    assert b.at("Y") == pytest.approx(5.0 + value)
    assert (b.now - begin > 0.5) == (value == -1.0)


def test_a_wait_is_held_and_gone_on_with(bench, probing: Machine) -> None:
    b = bench(probing).on()
    b.ok(c.Load(name="p", text="G21 G90\nG0 X1\nM66 P0 L3 Q20\nG0 Y[5 + #5399]\nM2\n"))
    b.ok(c.Run())
    b.run(0.6)
    b.ok(c.Hold())
    b.run(until="held")
    b.ok(c.SetInput(name="door", value=1))
    b.run(0.2)
    assert b.at("Y") == 0.0
    b.ok(c.Resume())
    b.run(until="idle")
    assert b.at("Y") == pytest.approx(6.0)


def test_block_by_block_over_questions(bench, probing: Machine) -> None:
    b = bench(probing).on()
    away(b)
    b.ok(c.Load(name="p", text=f"G21 G90\nG1 Y1 F600\n{FAST}G1 X31 F600\nM66 P0 L0\nG1 X32\nM2\n"))
    seen = []
    for _ in range(3):
        b.ok(c.Step())
        b.run(0.02)
        status = b.run(until="held")
        seen.append((round(b.at("X"), 9), round(b.at("Y"), 9), b.at("Z") < -12.0))
        assert status.request is not None
    assert seen == [(30.0, 1.0, False), (30.0, 1.0, True), (31.0, 1.0, True)]
    b.ok(c.Step())
    b.run(0.02)
    b.run(until="idle")
    assert b.at("X") == 32.0


def test_what_m66_asks_must_be_there(bench, mill: Machine) -> None:
    b = bench(mill).on()
    b.ok(c.Load(name="p", text="M66 P1 L0\nM2\n"))
    assert "no digital input number 1" in b.command(c.Run()).reason
    b.ok(c.Load(name="p", text="M66 E0 L0\nM2\n"))
    assert "no analogue input number 0" in b.command(c.Run()).reason


def test_only_free_inputs_of_a_twin_are_set(bench, probing: Machine) -> None:
    b = bench(probing).on()
    assert "no input 'lamp'" in b.command(c.SetInput(name="lamp", value=1)).reason
    assert "where the machine is" in b.command(c.SetInput(name="probe", value=1)).reason
    b.runtime.controller.report = replace(b.runtime.controller.report, settable=False)
    assert "real machine" in b.runtime.controller.command(c.SetInput(name="door", value=1), b.now).reason


def test_an_override_and_a_door_while_it_waits(bench, probing: Machine) -> None:
    b = bench(replace(probing, panel=Panel(door="door"), io=(*probing.io, Channel(name="go", kind="input")))).on()
    b.ok(c.Load(name="p", text="G21 G90\nG0 X1\nM66 P2 L3 Q60\nG1 Y20 F600\nM2\n"))
    b.ok(c.Run())
    b.run(0.6)
    b.ok(c.Override(feed=0.5))
    b.run(0.1)
    b.ok(c.SetInput(name="door", value=1))
    b.run(until="held")
    b.ok(c.SetInput(name="door", value=0))
    b.ok(c.SetInput(name="go", value=1))
    b.run(0.1)
    assert b.status.state == "held"
    b.ok(c.Resume())
    b.run(1.0)
    assert b.status.speed == pytest.approx(5.0)
    b.run(until="idle")
    assert b.at("Y") == pytest.approx(20.0)
