"""M100 to M199 on the command line: off, asked of the operator, or programs beside the machine file."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

import trochia
from trochia.machine.dump import dumps

if TYPE_CHECKING:
    from pathlib import Path

TEXT = "G21 G90 F600\nG1 X5\nM101 P2\nG1 X0\nM2\n"


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    """Return a folder with a machine file that names the folder ``codes``, its M101, and a program."""
    (tmp_path / "codes").mkdir()
    (tmp_path / "codes" / "M101").write_text("#!/bin/sh\necho $1 $2 > said\nexit ${CODE:-0}\n")
    (tmp_path / "codes" / "M101").chmod(0o755)
    text = dumps(trochia.load("xy-table"))
    (tmp_path / "with.toml").write_text(text.replace("\nname =", '\nuser_m_codes = "codes"\nname =', 1))
    (tmp_path / "asks.toml").write_text(text.replace("\nname =", "\nallow_user_m_codes = true\nname =", 1))
    (tmp_path / "part.ngc").write_text(TEXT)
    return tmp_path


def _call(shop: Path, machine: str, *words: str, answers: str = "", **env: str):
    code = "import sys; from trochia.cli import main; sys.argv[0] = 'trochia'; main()"
    command = [sys.executable, "-c", code, words[0], str(shop / "part.ngc"), "-m", machine, *words[1:]]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, input=answers, env={**os.environ, **env}
    )


@pytest.mark.parametrize("command", ["check", "plan"])
def test_they_are_off_unless_the_machine_allows_them(shop, command):
    result = _call(shop, "xy-table", command)
    assert result.returncode == 1
    assert "M101 is not known" in (result.stdout + result.stderr)
    assert "user_m_codes" in (result.stdout + result.stderr)


def test_what_would_be_called_is_told_and_not_called(shop):
    result = _call(shop, str(shop / "with.toml"), "check")
    assert result.returncode == 0
    assert "line 3: calls M101 P2" in (result.stdout + result.stderr)
    assert not (shop / "codes" / "said").exists()


def test_run_calls_the_program_and_goes_on(shop):
    result = _call(shop, str(shop / "with.toml"), "run", "--virtual", "-y")
    assert result.returncode == 0, result.stderr
    assert (shop / "codes" / "said").read_text() == "2.000000 -1.000000\n"


def test_an_exit_code_ends_the_run_with_an_alarm(shop):
    result = _call(shop, str(shop / "with.toml"), "run", "--virtual", "-y", CODE="7")
    assert result.returncode == 1
    assert "line 3: M101 ended with exit code 7" in (result.stdout + result.stderr)


def test_a_code_without_a_program_is_an_error_before_anything_moves(shop):
    (shop / "codes" / "M101").unlink()
    result = _call(shop, str(shop / "with.toml"), "run", "--virtual", "-y")
    assert result.returncode == 1
    assert "no program M101" in (result.stdout + result.stderr)


def test_a_folder_that_is_not_there_is_the_machine_files_fault(shop):
    (shop / "codes" / "M101").unlink()
    (shop / "codes").rmdir()
    result = _call(shop, str(shop / "with.toml"), "check")
    assert result.returncode == 2
    assert "there is no folder" in (result.stdout + result.stderr)


@pytest.mark.parametrize("answer", ["y", "n"])
def test_without_a_program_the_operator_is_asked(shop, answer):
    result = _call(shop, str(shop / "asks.toml"), "run", "--virtual", answers=f"y\ny\n{answer}\n")
    assert "M101 P2: do what it stands for" in result.stderr
    assert result.returncode == 0
