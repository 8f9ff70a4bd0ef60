"""What a user sees who has the wrong port, board, baud rate, image or cable: the commands as they are typed."""

from __future__ import annotations

import itertools
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.kernels.link import SCHEMA, TYPES, FrameReader, frame

if TYPE_CHECKING:
    from collections.abc import Callable

PROGRAM = "G1 G21 G90 X100 F1200\nX0\nM2\n"


@pytest.fixture
def trochia(tmp_path: Path) -> Callable[..., subprocess.Popen[str]]:
    """Starts the command line; a job lies in its folder."""
    (tmp_path / "job.ngc").write_text(PROGRAM)
    return lambda *words: subprocess.Popen(
        [Path(sys.executable).with_name("trochia"), *map(str, words)], cwd=tmp_path, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def run(trochia: Callable[..., subprocess.Popen[str]], port: Any, *more: str) -> subprocess.Popen[str]:
    return trochia("run", "job.ngc", "-m", "reference-mill", "--backend", "avr", "-y", "--port", port, *more)


def ended(process: subprocess.Popen[str]) -> tuple[str, str]:
    """Return what it said, and its complaint; a traceback is none."""
    out, err = process.communicate(timeout=60)
    assert "Traceback" not in err, err
    return out, err


def test_a_port_that_is_not_there(trochia: Callable[..., Any]):
    looked, process = trochia("boards", "/dev/not-there"), run(trochia, "/dev/not-there")
    assert ended(looked)[0] == "/dev/not-there  is not there\n"
    assert ended(process)[1] == "error: /dev/not-there is not there\n  `trochia boards` lists the ports.\n"
    assert process.returncode == 1


def test_strangers_and_boards_that_do_not_fit(plug: Callable[..., Any], trochia: Callable[..., Any]):
    """All at once, as each waits some seconds for an answer."""
    noise = itertools.cycle(np.random.default_rng(3).bytes(997))
    reader = FrameReader()

    def another(came: bytes) -> bytes:
        """An image whose answer is shorter than ours."""
        told = frame(0, TYPES["answer"], bytes.fromhex("78563412") + bytes(8))
        return b"".join(told for got in reader.feed(came) if got.kind == TYPES["hello"])

    ports = {
        "garbage": plug(answer=lambda came: bytes(itertools.islice(noise, 40)) if came else b"", name="garbage"),
        "version": plug(answer=another, name="version"),
        "baud": plug("uno-stepdir", baud=1_000_000, name="baud"),
        "board": plug("uno-stepdir", name="board"),
    }
    begun = {name: run(trochia, board.link, *(["--board", "mega-stepdir"] * (name == "board")))
             for name, board in ports.items()}  # fmt: skip
    said = {name: ended(process)[1] for name, process in begun.items()}
    assert {process.returncode for process in begun.values()} == {1}
    assert "make no sense: another baud rate, or another firmware" in said["garbage"]
    assert f"the board speaks schema 12345678, this program {SCHEMA:08x}\n" in said["version"]
    assert "`trochia flash`" in said["version"]
    assert "nothing answers at 115200 baud; there is uno-stepdir at 1000000 baud" in said["baud"]
    assert "Say --baud 1000000." in said["baud"]
    assert "the board is uno-stepdir, not mega-stepdir\n  Say --board uno-stepdir." in said["board"]
    looked = ended(trochia("boards", *(board.link for board in ports.values())))[0].splitlines()
    assert "make no sense" in looked[0]
    assert f"schema 12345678; this program speaks {SCHEMA:08x}: write its image with `trochia flash BOARD`" in looked[1]
    assert f"uno-stepdir at 1000000 baud, schema {SCHEMA:08x}" in looked[2]
    assert f"uno-stepdir at 115200 baud, schema {SCHEMA:08x}" in looked[3]


def moving(board: Any, steps: int) -> None:
    """Wait until a board has made so many."""
    end = time.monotonic() + 30.0
    while sum(np.count_nonzero((run["kind"] == 1) & (run["line"] == 2)) for run in list(board.runs)) < 2 * steps:
        assert time.monotonic() < end
        time.sleep(0.01)


def test_two_programs_then_a_cable_pulled_and_put_back(plug: Callable[..., Any], trochia: Callable[..., Any]):
    board = plug("uno-stepdir")
    first = run(trochia, board.link)
    moving(board.board, 200)
    others = run(trochia, board.link), trochia("boards", board.link)
    assert "is in use by another program" in ended(others[0])[1]
    assert "is in use by another program" in ended(others[1])[0]
    board.pull()
    out, _ = ended(first)
    assert first.returncode == 1
    assert "alarm after" in out
    assert f"the board on {board.link} is gone: " in out
    assert "Look at the cable" in out
    board.replug()
    (board.link.parent / "job.ngc").write_text("G1 G21 G90 X1 F1200\nX0\nM2\n")
    again = run(trochia, board.link)
    assert "idle after" in ended(again)[0]
    pins = np.concatenate(board.board.runs)
    pins = pins[(pins["kind"] == 1) & (pins["unit"] == b"D")]
    steps, turns = pins[(pins["line"] == 2) & (pins["value"] == 1)], pins[pins["line"] == 5]
    level = np.append(0, turns["value"])[turns["cycle"].searchsorted(steps["cycle"], side="right")]
    assert np.where(level, -1, 1).sum() == 0  # back where the first began: the board has kept count
