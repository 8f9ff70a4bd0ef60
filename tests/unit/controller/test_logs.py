"""Logs of programs under the live controller: written when a job is over, in one folder, and nowhere else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from trochia.backends.live_twin import LiveTwin
from trochia.controller.runtime import Runtime
from trochia.messages import command as c

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine

TEXT = "G21 G90 F1200\n(LOGOPEN, a.txt)\n(LOG, out)\nG1 X10\n(LOG, x is #<_x>)\nG1 X0\n(LOG, home)\nM2\n"


class Place:
    """A machine whose programs may write logs."""

    def __init__(self, machine: Machine, folder: Path | None) -> None:
        self.runtime = Runtime(LiveTwin(machine), logs=folder)
        self.now = 0.0
        self.does(c.Enable())
        self.until("idle")

    def does(self, command) -> tuple[bool, str]:
        answer = self.runtime.command(command, self.now)
        return answer.ok, answer.reason or answer.told

    def until(self, state: str) -> None:
        for _ in range(4000):
            self.now = round(self.now + 0.005, 9)
            if self.runtime.turn(self.now).state == state:
                return
        pytest.fail(f"{self.runtime.status.state}, not {state}")

    def runs(self, text: str, name: str = "part.ngc") -> tuple[bool, str]:
        loaded = self.does(c.Load(name=name, text=text))
        return self.does(c.Run()) if loaded[0] else loaded


def test_a_job_that_has_ended_leaves_its_log(mill: Machine, tmp_path: Path) -> None:
    place = Place(mill, tmp_path)
    assert place.runs(TEXT) == (True, "1.1 s")
    assert not list(tmp_path.iterdir())
    place.until("idle")
    place.runtime.close()
    assert (tmp_path / "a.txt").read_text() == " out\n x is 10.000000\n home\n"


def test_a_job_that_is_given_up_leaves_what_it_has_said(mill: Machine, tmp_path: Path) -> None:
    place = Place(mill, tmp_path)
    place.runs(TEXT)
    place.until("running")
    place.does(c.Hold())
    place.until("held")
    place.does(c.Abort())
    place.until("idle")
    place.runtime.close()
    assert (tmp_path / "a.txt").read_text() == " out\n"


def test_two_jobs_append_to_one_log(mill: Machine, tmp_path: Path) -> None:
    place = Place(mill, tmp_path)
    for _ in range(2):
        place.runs("(LOGAPPEND, all.txt)\n(LOG, once more)\nG21 G91 G1 F600 X1\nM2\n")
        place.until("idle")
    place.runtime.close()
    assert (tmp_path / "all.txt").read_text() == " once more\n once more\n"


@pytest.mark.parametrize("name", ["../out.txt", "/etc/out.txt", "..", ".hidden", "none/a.txt", "mill.toml"])
def test_a_name_that_leads_elsewhere_is_refused_before_anything_moves(mill: Machine, tmp_path: Path, name: str) -> None:
    folder = tmp_path / "logs"
    folder.mkdir()
    (folder / "mill.toml").write_text("kept")
    place = Place(mill, folder)
    ok, why = place.runs(f"(LOGOPEN, {name})\n(LOG, 1)\nG21 G91 G1 F600 X1\nM2\n", name="../../part.ngc")
    assert not ok
    assert "the log file" in why
    assert place.runtime.status.state == "idle"
    place.runtime.close()
    assert [path.name for path in folder.iterdir()] == ["mill.toml"]
    assert (folder / "mill.toml").read_text() == "kept"
    assert [path.name for path in tmp_path.iterdir()] == ["logs"]


def test_without_a_folder_it_is_said_that_logs_are_not_kept(mill: Machine) -> None:
    place = Place(mill, None)
    ok, told = place.runs(TEXT)
    assert ok
    assert told == "1.1 s; its logs are not kept: no folder was named for them (--logs)"
    place.until("idle")
    assert place.runs("G21 G91 G1 F600 X1\nM2\n")[1].endswith(" s")
    place.runtime.close()


def test_a_log_that_cannot_be_written_is_told(mill: Machine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, content: bytes) -> None:
        raise OSError(28, "No space left on device", str(path), content)

    monkeypatch.setattr("trochia.program.logs.write_whole", full)
    place = Place(mill, tmp_path)
    place.runs(TEXT)
    place.until("idle")
    place.runtime.controller.logs.close()
    for _ in range(5):
        place.until("idle")
    assert "a.txt cannot be written: No space left on device" in place.runtime.status.message
    place.runtime.close()


def test_a_name_found_out_after_an_answer_ends_the_program(mill: Machine, tmp_path: Path) -> None:
    place = Place(mill, tmp_path)
    ok, why = place.runs("G21 G91 F600\nG1 X1\nM66 P0 L0\n(LOGOPEN, .a)\nG1 X1\nM2\n")
    assert ok, why
    place.until("alarm")
    assert "the log file '.a' would be written over what is no log" in place.runtime.status.alarms[0].message
    place.runtime.close()
