"""M100 to M199 in the live controller: the machine waits at rest, goes on after exit code 0, else there is an alarm."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest

from trochia.controller.hooks import Hooks, codes_in
from trochia.errors import ConfigError
from trochia.messages import command as c
from trochia.program import WorkState

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine

PROGRAM = "G21 G90 G94 F3000\nG1 X5\n{code}\nG1 X0\nM2\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder: M101 writes down what it gets, M102 fails, M103 takes its time, M104 is no program."""
    scripts = {
        "M101": "echo $1 $2 >> said",
        "M102": "echo first\necho the vacuum is low >&2\nexit 3",
        "M103": "echo $$ > number\nexec sleep 60",
    }
    for name, body in scripts.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{body}\n")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "M104").write_text("no program")
    (tmp_path / "M100.txt").write_text("no program")
    return tmp_path


def _loaded(bench, machine, folder, code, *, blocking=True, **options):
    b = bench(machine, **options).on()
    b.runtime.controller.work = WorkState(user_codes=True)
    b.hooks = Hooks(folder, b.runtime, blocking=blocking)
    b.ok(c.Load(name="part", text=PROGRAM.format(code=code)))
    b.ok(c.Run())
    return b


def test_the_programs_of_a_folder_are_those_that_can_be_executed(folder: Path) -> None:
    assert codes_in(folder) == {101, 102, 103}
    with pytest.raises(ConfigError, match="there is no folder"):
        codes_in(folder / "elsewhere")


def test_a_code_is_called_with_p_and_q_at_rest_and_waited_for(bench, mill: Machine, folder: Path) -> None:
    b = _loaded(bench, mill, folder, "M101 P2.5\nM101 Q-3")
    status = b.run(until="idle")
    assert (folder / "said").read_text() == "2.500000 -1.000000\n-1.000000 -3.000000\n"
    assert not status.alarms
    called = [at for _, _, _, at in b.trace if at.request is not None and at.request.kind == "hook"]
    assert [at.axes[0].commanded for at in called] == pytest.approx([5.0] * len(called))
    assert called
    assert all(at.speed == 0.0 for at in called)


def test_an_exit_code_is_an_alarm_with_the_line_and_the_last_words(bench, mill: Machine, folder: Path) -> None:
    b = _loaded(bench, mill, folder, "M102")
    (alarm,) = b.run(until="alarm").alarms
    assert "line 3: M102 ended with exit code 3: the vacuum is low" in alarm.message
    assert b.run(0.5).axes[0].commanded == pytest.approx(5.0)
    b.ok(c.Acknowledge())
    assert b.run(0.2).state == "idle"


def test_a_program_that_cannot_be_started_is_an_alarm(bench, mill: Machine, folder: Path) -> None:
    b = _loaded(bench, mill, folder, "M101")
    (folder / "M101").unlink()
    (alarm,) = b.run(until="alarm").alarms
    assert "M101 cannot be started" in alarm.message


def test_nobody_goes_on_while_a_program_runs_and_an_abort_ends_it(bench, mill: Machine, folder: Path) -> None:
    b = _loaded(bench, mill, folder, "M103", blocking=False)
    b.run(until="held")
    b.run(0.05)
    refused = b.command(c.Resume())
    assert not refused.ok
    assert "M103 still runs" in refused.reason
    for _ in range(500):
        if (folder / "number").exists() and (folder / "number").read_text().strip():
            break
        time.sleep(0.01)
    number = int((folder / "number").read_text())
    b.ok(c.Abort())
    b.run(0.1)
    b.hooks.close()
    with suppress(ProcessLookupError):
        os.kill(number, 0)
        pytest.fail("the program still runs")
    assert b.run(until="idle").axes[0].commanded == pytest.approx(5.0)


def test_a_code_without_a_program_asks_the_operator(bench, mill: Machine, folder: Path) -> None:
    b = _loaded(bench, mill, folder, "M150 P1")
    status = b.run(until="held")
    assert status.request is not None
    assert status.request.kind == "code"
    assert "M150 P1" in status.request.text
    b.run(0.2)
    b.ok(c.Resume())
    b.run(until="idle")


def test_a_dry_run_calls_nothing(bench, mill: Machine, folder: Path) -> None:
    b = bench(mill).on()
    b.runtime.controller.work = WorkState(user_codes=True)
    Hooks(folder, b.runtime, blocking=True)
    b.ok(c.Switches(dry_run=True))
    b.ok(c.Load(name="part", text=PROGRAM.format(code="M101")))
    b.ok(c.Run())
    b.run(until="idle")
    assert not (folder / "said").exists()
