"""`trochia serve` and `trochia users` as a person uses them."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from trochia.client import Client
from trochia.controller.journal import entries
from trochia.controller.offsets import kept_work
from trochia.messages.command import Enable, JogBy, Load, Run, WorkZero

TROCHIA = Path(sys.executable).with_name("trochia")


def _run(*arguments: str, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run([TROCHIA, *arguments], capture_output=True, text=True, check=False, timeout=60, **more)


@pytest.fixture
def served(tmp_path):
    """Start a server in a process of its own; give it, its address and the password it showed."""
    process = subprocess.Popen(
        [TROCHIA, "serve", "-m", "reference-mill", "--tcp", "0", "--users", tmp_path / "users.json", "--journal",
         tmp_path / "journal", "--logs", tmp_path / "logs"],
        stdout=subprocess.PIPE, text=True, env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    assert process.stdout is not None
    password = re.search(r"password (\S+)", process.stdout.readline())
    assert password is not None
    assert "shown this once" in process.stdout.readline()
    address = re.search(r"http://127\.0\.0\.1:\d+", process.stdout.readline())
    assert address is not None
    yield process, address[0], password[1]
    process.kill()
    process.communicate()


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_end_brakes_what_moves_and_switches_the_drives_off(served, tmp_path, how: signal.Signals) -> None:
    process, address, password = served
    with Client.connect(address, "operator", password) as client:
        client.take()
        client.command(Enable())
        client.command(JogBy(way={"X": 100.0}, speed=20.0))
        client.wait_until(lambda status: status.axes[0].velocity > 10.0, timeout=30.0)
        process.send_signal(how)
        rest, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert rest.endswith("at rest, drives off\n")
    kept = list(entries(tmp_path / "journal"))
    states = [entry["state"] for entry in kept if entry["kind"] == "state"]
    assert states == ["idle", "jogging", "stopping", "idle", "off"]
    assert kept[-1]["kind"] == "closed"
    places = [entry["position"]["X"] for entry in kept if entry["kind"] == "point"]
    assert 0.0 < places[-1] < 100.0
    assert sum(entry["kind"] == "login" for entry in entries(tmp_path / "journal" / "access")) == 1


def test_logs_of_programs_lie_in_their_folder(served, tmp_path) -> None:
    process, address, password = served
    with Client.connect(address, "operator", password) as client:
        client.take()
        client.command(Enable())
        client.command(Load(name="../part.ngc", text="(LOGOPEN, part.txt)\nG21 G91 G1 F6000 X1\n(LOG,X #<_x>)\nM2\n"))
        client.command(Run())
        client.wait_until(lambda status: status.state == "idle" and status.message == "X 1.000000", timeout=30.0)
    process.terminate()
    process.communicate(timeout=60)
    assert (tmp_path / "logs" / "part.txt").read_text() == "X 1.000000\n"


def test_a_folder_of_logs_that_cannot_be_made_is_one_message(tmp_path) -> None:
    (tmp_path / "file").touch()
    done = _run("serve", "-m", "reference-mill", "--users", str(tmp_path / "u"), "--logs", str(tmp_path / "file/logs"))
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "file/logs" in done.stderr


def test_beyond_this_computer_only_under_names(tmp_path) -> None:
    done = _run("serve", "-m", "reference-mill", "--host", "0.0.0.0", "--users", str(tmp_path / "u"))  # noqa: S104
    assert done.returncode == 2
    assert "--allow" in done.stderr
    assert not (tmp_path / "u").exists()


def test_a_port_that_is_taken_is_said(tmp_path, served) -> None:
    _, address, _ = served
    done = _run("serve", "-m", "reference-mill", "--tcp", address.rpartition(":")[2], "--users", str(tmp_path / "u"))
    assert done.returncode == 2
    assert "cannot listen" in done.stderr


def test_users_are_added_listed_and_removed(tmp_path) -> None:
    users = ["--users", str(tmp_path / "users.json")]
    shown = _run("users", "add", "ada", *users)
    assert re.search(r"user ada, password \S{19}", shown.stdout)
    assert _run("users", "add", "eve", "--viewer", "--password-stdin", *users, input="quite long\n").returncode == 0
    assert _run("users", "list", *users).stdout == "ada\toperator\neve\tviewer\n"
    assert _run("users", "remove", "ada", *users).returncode == 0
    assert "there is no user 'ada'" in _run("users", "remove", "ada", *users).stderr
    assert _run("users", "list", *users).stdout == "eve\tviewer\n"
    short = _run("users", "add", "bob", "--password-stdin", *users, input="short\n")
    assert (short.returncode, "at least 8" in short.stderr) == (2, True)


def test_no_users_are_known_before_the_first(tmp_path) -> None:
    assert _run("users", "list", "--users", str(tmp_path / "none.json")).stdout == ""


def test_offsets_are_there_again_after_a_kill(served, tmp_path) -> None:
    process, address, password = served
    with Client.connect(address, "operator", password) as client:
        client.take()
        client.command(Enable())
        client.command(WorkZero(axes={"X": -12.5}))
        process.kill()
    process.wait()
    kept = kept_work(tmp_path / "journal" / "parameters.var")
    assert kept.systems[0][0] == 12.5
    command = [TROCHIA, "serve", "-m", "reference-mill", "--tcp", "0", "--users", tmp_path / "users.json", "--journal",
               tmp_path / "journal"]  # fmt: skip
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as again:
        assert again.stdout is not None
        found = re.search(r"http://127\.0\.0\.1:\d+", again.stdout.readline())
        assert found is not None
        with Client.connect(found[0], "operator", password) as client:
            assert client.status.axes[0].work == -12.5
        again.terminate()
