"""Logs of programs on the command line: written by what runs a program, shown by the others."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

TEXT = "G21 G90 F1200\n(MSG,hello)\n(LOGOPEN,{name})\nG1 X2\n(LOG,%d#<_x>)\nM2\n"


def _call(folder: Path, *words: str, name: str = "a.txt") -> subprocess.CompletedProcess[str]:
    (folder / "part.ngc").write_text(TEXT.format(name=name))
    code = "import sys; from trochia.cli import main; sys.argv[0] = 'trochia'; main()"
    command = [sys.executable, "-c", code, words[0], str(folder / "part.ngc"), "-m", "reference-mill", *words[1:]]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)


@pytest.mark.parametrize("words", [("simulate", "-o", "out"), ("run", "--virtual", "-y")])
def test_what_runs_a_program_writes_its_log_and_says_where(tmp_path: Path, words: tuple[str, ...]) -> None:
    done = _call(tmp_path, *words)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.txt").read_text() == "2\n"
    assert f"log      {tmp_path / 'a.txt'}" in done.stdout
    assert done.stderr.count("line 2: hello") == 1
    assert json.loads(_call(tmp_path, *words, "--json").stdout)["logs"] == [str(tmp_path / "a.txt")]


@pytest.mark.parametrize("command", ["check", "plan"])
def test_what_only_reads_it_shows_it(tmp_path: Path, command: str) -> None:
    done = _call(tmp_path, command)
    assert done.returncode == 0
    assert "line 5: 2" in done.stderr
    assert not (tmp_path / "a.txt").exists()


@pytest.mark.parametrize("words", [("simulate", "-o", "out"), ("run", "--virtual", "-y")])
def test_a_log_over_the_program_is_refused_before_anything_moves(tmp_path: Path, words: tuple[str, ...]) -> None:
    done = _call(tmp_path, *words, name="part.ngc")
    assert done.returncode == 1
    assert "part.ngc:3: the log file 'part.ngc' is the program itself" in done.stderr
    assert not (tmp_path / "out").exists()
