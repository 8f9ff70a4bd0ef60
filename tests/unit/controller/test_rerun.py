"""Beginning inside a program: the way there, what is set up again, and going on after a power cut."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from trochia.controller.interrupted import interrupted, keep
from trochia.controller.rerun import entry, move_of_line
from trochia.errors import LocalProtocolError, RecordingError
from trochia.languages import gcode
from trochia.machine.io import Spindle
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.machine.machine import Machine

POCKET = """G21 G90 G94 G64
T2 M6
M3 S800
M64 P0
G0 Z5
X10 Y10
G1 Z-1 F300
X30 F1200
Y30
X10
Y10
G0 Z5
M65 P0
M2
"""


@pytest.fixture
def cutter(mill: Machine) -> Machine:
    return replace(mill, spindle=Spindle(maximum=3000.0))


def ready(b, machine: Machine) -> None:
    assert machine is b.machine
    b.ok(c.JogBy(way={"X": 50.0, "Z": -8.0}))
    b.run(until="idle")
    b.ok(c.Load(name="pocket", text=POCKET))


def test_the_first_answer_tells_the_way_and_nothing_moves(bench, cutter: Machine) -> None:
    b = bench(cutter).on()
    ready(b, cutter)
    told = b.ok(c.RunFrom(line=9)).told
    assert told.startswith(
        "the way to line 9, then Z5.000, then X30.000 Y10.000, then Z-1.000, then tool 2, then spindle"
    )
    assert b.run(0.3).state == "idle"
    assert (b.at("X"), b.at("Z")) == pytest.approx((50.0, -8.0))


def test_it_goes_up_over_and_down_and_on_with_all_that_was_set_up(bench, cutter: Machine) -> None:
    b = bench(cutter).on()
    ready(b, cutter)
    b.trace.clear()
    b.ok(c.RunFrom(line=9, confirmed=True))
    status = b.run(until="held")
    assert status.request is not None
    assert "tool 2" in status.request.text
    assert b.at("Z") == -8.0  # nothing has moved before the tool is in
    b.ok(c.Answer(request=status.request.number))
    b.run(until="idle")
    status = b.run(0.02)
    way = np.array([position for _, position, _, _ in b.trace])
    over = way[(np.abs(way[:, 0] - 30.0) > 0.02) & (way[:, 0] > 30.0)]
    assert over[:, 2].max() == pytest.approx(5.0, abs=1e-6)
    assert np.abs(over[np.abs(over[:, 0] - 50.0) > 0.01, 2] - 5.0).max() < 0.02  # across at the top alone
    cutting = [(p, s) for _, p, _, s in b.trace if p[2] < -0.99 and p[1] > 11.0]
    assert cutting
    assert {s.spindle for _, s in cutting} == {800.0}
    assert {s.io["lamp"] for _, s in cutting} == {1.0}
    assert status.io["lamp"] == 0.0
    assert [axis.commanded for axis in status.axes] == pytest.approx([10.0, 10.0, 5.0], abs=1e-9)
    assert not np.any((way[:, 0] > 12.0) & (way[:, 0] < 28.0) & (np.abs(way[:, 1] - 10.0) < 0.5) & (way[:, 2] < 0.0))


def test_a_line_in_which_nothing_moves_is_refused_and_the_next_named(bench, cutter: Machine) -> None:
    b = bench(cutter).on()
    assert not b.command(c.RunFrom(line=3)).ok
    ready(b, cutter)
    answer = b.command(c.RunFrom(line=3))
    assert not answer.ok
    assert "nothing moves in line 3" in answer.reason
    answer = b.command(c.RunFrom(line=0))
    assert "no job was interrupted" in answer.reason


def test_a_machine_without_z_goes_straight_there_dark(bench, laser: Machine) -> None:
    b = bench(laser).on()
    b.ok(c.ArmBeam(on=True))
    b.ok(c.Load(name="p", text="G21 G90 M3 S50\nG1 X10 F1800\nY10\nX0\nM2\n"))
    b.ok(c.RunFrom(line=3, confirmed=True))
    b.run(until="idle")
    lit = np.array([position for _, position, beam, _ in b.trace if beam])
    assert lit[:, 0].max() <= 10.0 + 1e-6
    assert not np.any((lit[:, 1] < 0.01) & (lit[:, 0] < 9.9))


@pytest.mark.parametrize("line", [5, 7, 8, 9, 12])
def test_moves_after_the_entry_are_those_of_the_program(mill: Machine, line: int) -> None:
    program = gcode.read(POCKET)
    move = move_of_line(program, line)
    made = entry(program, move, mill, at=np.array([1.0, 2.0, 3.0, 0, 0, 0, 0, 0, 0]), tool=2)
    np.testing.assert_array_equal(made.program.moves[made.way :], program.moves[move:])
    assert [made.original(made.way + k) for k in range(3)] == [move, move + 1, move + 2]
    assert made.original(0) == move
    assert all(a.at <= b.at for a, b in zip(made.program.actions, made.program.actions[1:], strict=False))


def test_after_a_power_cut_the_machine_says_where_it_was_and_goes_on_there(bench, cutter: Machine, tmp_path) -> None:
    b = bench(cutter, journal=tmp_path).on()
    b.ok(c.Load(name="pocket", text=POCKET))
    b.ok(c.Run())
    b.run(until="held")
    b.ok(c.Resume())
    while b.at("Z") > -0.5 or b.at("X") < 20.0:
        b.run(0.0)
    cut = b.status
    job = interrupted(tmp_path)  # as a new process finds it: nothing was closed
    assert job is not None
    assert not job.closed
    assert job.line == cut.program.line == 8
    assert abs(job.position["X"] - cut.axes[0].commanded) <= 20.0 * 0.02
    assert job.distance == pytest.approx(job.position["X"] - 10.0, abs=0.05)
    again = bench(cutter, journal=tmp_path)
    status = again.run(0.02)
    assert status.state == "alarm"
    assert "line 8" in status.alarms[0].message
    again.ok(c.Acknowledge())
    again.run(0.02)
    again.on()
    assert "Home first" in again.command(c.RunFrom(line=0)).reason
    again.ok(c.Home())
    again.run(until="idle")
    assert "line 8" in again.ok(c.RunFrom(line=0)).told
    again.ok(c.RunFrom(line=0, confirmed=True))
    again.run(until="held")
    again.ok(c.Resume())
    status = again.run(until="idle")
    assert [axis.commanded for axis in status.axes] == pytest.approx([10.0, 10.0, 5.0], abs=1e-9)
    cutting = np.array([p for _, p, _, _ in again.trace if p[2] < -0.99])
    assert cutting[0][0] == pytest.approx(job.position["X"], abs=0.05)
    assert interrupted(tmp_path) is None


def test_an_aborted_job_can_be_gone_on_with(bench, mill: Machine, tmp_path) -> None:
    b = bench(mill, journal=tmp_path).on()
    b.ok(c.Load(name="x", text="G21 G90 G94\nG1 X40 F1200\nM2\n"))
    b.ok(c.Run())
    b.run(0.5)
    b.ok(c.Abort())
    b.run(until="idle")
    stopped = b.at("X")
    b.ok(c.Mdi(text="G0 X5"))
    b.run(until="idle")
    b.ok(c.RunFrom(line=0, confirmed=True))
    b.run(until="idle")
    slow = [p[0] for _, p, _, s in b.trace[-400:] if 0.0 < s.speed <= 20.001]
    assert min(slow) >= 5.0
    assert b.at("X") == pytest.approx(40.0, abs=1e-9)
    assert stopped < 40.0
    assert interrupted(tmp_path) is None


def test_a_program_that_was_kept_and_damaged_is_not_run(tmp_path) -> None:
    digest = keep(tmp_path, "G1 X1\n")
    assert digest == keep(tmp_path, "G1 X1\n")
    path = tmp_path / "programs" / f"{digest}.ngc"
    path.write_text("G1 X100\n")
    from trochia.controller.journal import Journal  # noqa: PLC0415 - of this test alone

    book = Journal(tmp_path)
    book.write("job", 0.0, name="p", program=digest, start={"X": 0.0}, work={})
    book.close()
    with pytest.raises(RecordingError, match="damaged"):
        interrupted(tmp_path)
    path.unlink()
    job = interrupted(tmp_path)
    assert job is not None
    assert job.text == ""


def test_lines_are_found_by_their_first_move() -> None:
    program = gcode.read("o1 repeat [3]\nG91 G1 X1 F100\no1 endrepeat\nM2\n")
    assert move_of_line(program, 2) == 0
    with pytest.raises(LocalProtocolError, match="line 3"):
        move_of_line(program, 3)
