"""Offsets and variables outlast the controller, whole or not at all; programs are read in the machine's language."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from trochia.backends.live_twin import LiveTwin
from trochia.controller.offsets import kept_work
from trochia.controller.runtime import Runtime
from trochia.errors import ConfigError
from trochia.languages.gcode import Reading
from trochia.messages import command as c
from trochia.program import WorkState

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine


def go(runtime: Runtime, *commands: c.AnyCommand) -> None:
    now = runtime.status.time
    for command in commands:
        answer = runtime.command(command, now)
        assert answer.ok, answer.reason
        for _ in range(400):
            now = round(now + 0.005, 9)
            if runtime.turn(now).state in {"idle", "off"}:
                break


def test_offsets_are_there_after_a_restart(mill: Machine, tmp_path: Path) -> None:
    path = tmp_path / "journal" / "parameters.var"
    first = Runtime(LiveTwin(mill), keep=path)
    go(first, c.Enable(), c.WorkZero(axes={"X": 12.5}, system=2))
    assert path.exists()  # with a process that dies now
    go(first, c.Mdi(text="G92 Y3\nG55"))
    second = Runtime(LiveTwin(mill), keep=path)
    work = second.controller.work
    assert work.systems[1][0] == pytest.approx(-12.5)
    assert (work.active, work.g92_on, work.g92[1]) == (1, True, -3.0)  # M2 goes back to G54


def test_a_file_is_written_only_when_something_changes(mill: Machine, tmp_path: Path) -> None:
    path = tmp_path / "parameters.var"
    runtime = Runtime(LiveTwin(mill), keep=path)
    go(runtime, c.Enable(), c.Mdi(text="G0 X1"))
    assert not path.exists()
    go(runtime, c.Mdi(text="G10 L2 P1 Z1.25"))
    before = path.stat().st_mtime_ns
    go(runtime, c.Mdi(text="G0 X0"))
    assert path.stat().st_mtime_ns == before
    assert list(tmp_path.iterdir()) == [path]  # no draft is left


def test_variables_that_a_file_names_are_kept(mill: Machine, tmp_path: Path) -> None:
    path = tmp_path / "parameters.var"
    path.write_text("100\t1.5\n5221\t2.0\n")
    runtime = Runtime(LiveTwin(mill), keep=path)
    go(runtime, c.Enable(), c.Mdi(text="#100=[#100 + 1]"))
    assert kept_work(path).variables[100] == 2.5
    assert kept_work(path).systems[0][0] == 2.0


def test_a_damaged_file_is_told_at_the_start(mill: Machine, tmp_path: Path) -> None:
    path = tmp_path / "parameters.var"
    path.write_text("5221 1\n5220 1\n")
    with pytest.raises(ConfigError, match="stands behind"):
        Runtime(LiveTwin(mill), keep=path)


def test_a_file_that_cannot_be_written_is_told_in_the_journal_and_stops_nothing(mill: Machine, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    runtime = Runtime(LiveTwin(mill), keep=tmp_path / "file" / "parameters.var", journal=tmp_path / "journal")
    go(runtime, c.Enable(), c.Mdi(text="G10 L2 P1 Z1.25"))
    text = "".join(path.read_text() for path in (tmp_path / "journal").glob("*.log"))
    assert "offsets are not kept" in text
    assert runtime.status.state == "idle"


def test_without_a_file_what_is_given_holds(tmp_path: Path) -> None:
    given = WorkState(tool=3)
    assert kept_work(tmp_path / "none.var", given) is given


def test_programs_are_read_in_the_machines_language_and_from_its_folders(mill: Machine, tmp_path: Path) -> None:
    (tmp_path / "shift.ngc").write_text("o<shift> sub\nG0 X#1\no<shift> endsub\nM2\n")
    runtime = Runtime(LiveTwin(mill), reading=Reading(subroutines=(tmp_path,)))
    go(runtime, c.Enable(), c.Mdi(text="o<shift> call [7]"))
    assert runtime.status.axes[0].commanded == pytest.approx(7.0)
    marlin = Runtime(LiveTwin(replace(mill, dialect="marlin")))
    go(marlin, c.Enable(), c.Mdi(text="G1 X4 F600 E1.5"), c.JogBy(way={"Y": 2.0}))
    assert [axis.commanded for axis in marlin.status.axes[:2]] == pytest.approx([4.0, 2.0])
