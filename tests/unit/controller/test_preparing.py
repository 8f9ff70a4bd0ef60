"""Long programs are planned beside the turns: what is passed on and when, what a stop does to a start."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from typing import TYPE_CHECKING

import pytest

from trochia.controller.interrupted import PROGRAMS, draft, keep
from trochia.controller.preparing import LONG, Preparer
from trochia.messages.command import Hold, Jog, Load, Run, Unload

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.messages import Ack, AnyCommand

TEXT = "G21 G90 G64 P0.01\nF600\n" + "".join(f"G1 X{k % 7} Y{k % 3}\n" for k in range(LONG // 8)) + "M2\n"
SOON = 30.0


class Turns:
    """A controller whose turns take a command at once, and its preparer, whose planning waits for ``go``."""

    def __init__(self, bench):
        self.bench, self.controller = bench, bench.runtime.controller
        self.passed: list[str] = []
        self.drafted: list[str] = []
        self.go, self.begun = threading.Event(), threading.Event()
        self.preparer = Preparer(self.controller, self._pass, self.drafted.append)
        self._prepare, self.controller.readier.prepare = self.controller.readier.prepare, self._slowly

    def _slowly(self, *args, **kwargs):
        self.begun.set()
        assert self.go.wait(SOON)
        return self._prepare(*args, **kwargs)

    def _pass(self, command, answer):
        self.passed.append(type(command).__name__)
        answer.set_result(self.controller.command(command, 0.0))

    def send(self, command: AnyCommand) -> tuple[bool, Future[Ack]]:
        answer: Future[Ack] = Future()
        return self.preparer.take(command, answer), answer


@pytest.fixture
def turns(mill, bench):
    return Turns(bench(mill).on())


def test_a_long_program_is_loaded_when_it_is_planned(turns):
    taken, answer = turns.send(Load(name="long.ngc", text=TEXT))
    assert taken
    assert turns.begun.wait(SOON)
    assert turns.preparer.planning == "long.ngc"
    assert not turns.passed
    turns.go.set()
    assert answer.result(SOON).ok
    assert turns.controller.loaded == ("long.ngc", TEXT)
    assert turns.drafted == [TEXT]


def test_what_is_planned_or_short_or_another_matter_goes_to_the_turns_at_once(turns):
    turns.go.set()
    assert turns.send(Load(name="long.ngc", text=TEXT))[1].result(SOON).ok
    while turns.preparer.planning:
        pass
    assert not turns.send(Run())[0]
    assert not turns.send(Load(name="short.ngc", text="G1 X1 F600\nM2\n"))[0]
    assert not turns.send(Jog(axis="X", speed=1.0))[0]


def test_commands_of_the_program_stay_in_their_order(turns):
    turns.send(Load(name="long.ngc", text=TEXT))
    assert turns.send(Unload())[0]
    taken, answer = turns.send(Load(name="short.ngc", text="G1 X1 F600\nM2\n"))
    assert taken
    turns.go.set()
    assert answer.result(SOON).ok
    assert turns.passed == ["Load", "Unload", "Load"]
    assert turns.controller.loaded[0] == "short.ngc"


def test_nothing_begins_after_a_stop(turns):
    turns.send(Load(name="long.ngc", text=TEXT))
    _, start = turns.send(Run())
    assert not turns.send(Hold())[0]
    turns.go.set()
    answer = start.result(SOON)
    assert not answer.ok
    assert "stopped" in answer.reason
    assert turns.passed == ["Load"]
    assert turns.controller.activity is None


def test_a_fault_of_the_program_is_found_beside_the_turns_and_said_once_by_them(turns):
    turns.go.set()
    _, answer = turns.send(Load(name="wrong.ngc", text=TEXT.replace("M2", "G1 X9999\nM2")))
    told = answer.result(SOON)
    assert not told.ok
    assert "9999" in told.reason or "X" in told.reason
    assert not turns.drafted


def test_a_jog_does_not_take_the_programs_place(mill, bench):
    readier, work = bench(mill).runtime.controller.readier, bench(mill).runtime.controller.work
    here: dict[str, float] = {"X": 0.0}
    made = readier.ready("G1 X1 F600\nM2\n", "part.ngc", work=work, at=here)
    readier.ready("G1 X2 F600\nM2\n", "<jog>", work=work, at=here)
    assert readier.knows(made.text, made.name, work=work, at=here, block_delete=False, exact=False)
    assert readier.ready(made.text, made.name, work=work, at=here) is made


def test_a_draft_becomes_what_is_kept(tmp_path: Path):
    digest = draft(tmp_path, "G1 X1\n")
    folder = tmp_path / PROGRAMS
    assert not list(folder.glob("*.ngc"))
    other = draft(tmp_path, "G1 X2\n")
    assert [path.stem for path in folder.iterdir()] == [other]  # one draft
    assert keep(tmp_path, "G1 X1\n", digest) == digest  # its draft is gone
    assert (folder / f"{digest}.ngc").read_text() == "G1 X1\n"
    assert keep(tmp_path, "G1 X2\n", draft(tmp_path, "G1 X2\n")) == other
    assert not list(folder.glob("*.part"))
