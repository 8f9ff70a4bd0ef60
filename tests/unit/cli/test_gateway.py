"""`trochia gateway grbl` and `trochia run --backend grbl`, each in a process of its own, as people use them."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

TROCHIA = Path(sys.executable).with_name("trochia")
PROGRAM = (
    "G21 G90\no1 repeat [2]\nG1 X4 Y0 F3000\nG2 X4 Y2 J1\nG1 X0\nG1 Y0\no1 endrepeat\nG81 X1 Y1 Z-1 R1 F3000\nM2\n"
)


def trochia(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([TROCHIA, *arguments], capture_output=True, text=True, check=False, timeout=60)


@pytest.fixture
def gateway() -> Iterator[Callable[..., str]]:
    started: list[subprocess.Popen[str]] = []

    def start(*options: str | Path) -> str:
        process = subprocess.Popen([TROCHIA, "gateway", "grbl", "-m", "reference-mill", *options],
                                   stdout=subprocess.PIPE, text=True,
                                   env=os.environ | {"PYTHONUNBUFFERED": "1"})  # fmt: skip
        started.append(process)
        assert process.stdout is not None
        return process.stdout.readline().split(" at ")[1].split()[0]

    yield start
    for process in started:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)
        assert process.returncode == 0


def test_a_program_runs_through_the_gateway(gateway: Callable[..., str], tmp_path: Path) -> None:
    name = gateway("--pty", "--link", tmp_path / "port")
    assert name == str(tmp_path / "port")
    (tmp_path / "part.ngc").write_text(PROGRAM)
    done = trochia("run", tmp_path / "part.ngc", "-m", "reference-mill", "--backend", "grbl", "--port", name, "-y",
                   "--json")  # fmt: skip
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["ok"]
    assert answer["state"] == "idle"
    assert answer["line"] == 9
    assert answer["time_s"] > 1.0


def test_a_tcp_sender_is_served_and_a_second_one_sent_away(gateway: Callable[..., str]) -> None:
    host, port = gateway("--tcp", "127.0.0.1:0").split(":")
    with socket.create_connection((host, int(port)), 10) as one, one.makefile("rb") as lines:
        assert lines.readline() == b"Grbl 1.1h ['$' for help]\r\n"
        with socket.create_connection((host, int(port)), 10) as other, other.makefile("rb") as refused:
            assert b"another sender" in refused.readline()
        one.sendall(b"$I\n")
        assert lines.readline().startswith(b"[VER:1.1h")
    with socket.create_connection((host, int(port)), 10) as again, again.makefile("rb") as lines:
        assert lines.readline() == b"Grbl 1.1h ['$' for help]\r\n"


@pytest.mark.parametrize(("arguments", "says"), [
    (("gateway", "grbl", "-m", "reference-mill"), "--tcp HOST:PORT and --pty"),
    (("gateway", "grbl", "-m", "reference-mill", "--tcp", "0.0.0.0:0"), "--public"),
    (("gateway", "grbl", "-m", "reference-mill", "--tcp", "here"), "expected HOST:PORT"),
    (("gateway", "grbl", "-m", "reference-mill", "--tcp", "127.0.0.1:0", "--link", "x"), "needs --pty"),
    (("run", "-", "-m", "reference-mill", "--backend", "grbl"), "go together"),
    (("run", "-", "-m", "reference-mill", "--port", "x"), "go together"),
    (("run", "-", "-m", "reference-mill", "--backend", "grbl", "--port", "x", "--virtual"), "own clock"),
])  # fmt: skip
def test_what_makes_no_sense_is_refused(arguments: tuple[str, ...], says: str) -> None:
    done = trochia(*arguments)
    assert done.returncode == 2
    assert says in done.stderr


def test_a_port_that_is_not_there_is_told(tmp_path: Path) -> None:
    (tmp_path / "part.ngc").write_text(PROGRAM)
    done = trochia("run", tmp_path / "part.ngc", "-m", "reference-mill", "--backend", "grbl", "--port",
                   tmp_path / "none", "-y")  # fmt: skip
    assert done.returncode == 1
    assert "cannot be opened" in done.stderr
    assert "Traceback" not in done.stderr
