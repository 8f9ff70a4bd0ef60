"""The board in a machine file: `check`, `plan` and what moves the machine know it, and the command line comes first."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

import trochia
from trochia.backends.avr.wiring import BOARDS
from trochia.cli import check, plan, run, serve
from trochia.cli.mover import board_of
from trochia.errors import ConfigError
from trochia.machine.board import BOARD_NAMES, BoardLink
from trochia.machine.dump import dumps
from trochia.machine.load import loads

if TYPE_CHECKING:
    from pathlib import Path

FAST = "G21 G90 F30000\nG1 X60 Y60 Z30\nX0 Y0 Z0\nM2\n"
FILE = BoardLink(kind="mega-stepdir", baud=1_000_000)


def test_boards_are_those_that_there_are_images_for() -> None:
    assert set(BOARD_NAMES) == set(BOARDS)


def test_it_is_read_as_it_is_written() -> None:
    machine = replace(trochia.load("reference-mill"), board=FILE)
    text = dumps(machine)
    assert '[board]\nkind = "mega-stepdir"\nbaud = 1000000\n' in text
    assert loads(text).board == FILE


@pytest.mark.parametrize(
    ("lines", "why"),
    [('kind = "uno"', "uno-stepdir"), ("baud = 115200", "kind"), ('kind = "uno-stepdir"\nbaud = 0', "above zero"),
     ('kind = "uno-stepdir"\nbaud = "fast"', "whole number"), ('kind = "uno-stepdir"\nport = "x"', "port")],
)  # fmt: skip
def test_what_is_wrong_is_named(lines: str, why: str) -> None:
    with pytest.raises(ConfigError, match=why) as caught:
        loads(dumps(trochia.load("reference-mill")) + f"\n[board]\n{lines}\n")
    assert caught.value.key is not None
    assert caught.value.key.startswith("board")


@pytest.mark.parametrize(
    ("file", "board", "baud", "found"),
    [
        (None, None, None, None),
        (None, None, 1_000_000, None),
        (None, "uno-stepdir", None, ("uno-stepdir", 115_200)),
        (FILE, None, None, ("mega-stepdir", 1_000_000)),
        (FILE, None, 115_200, ("mega-stepdir", 115_200)),
        (FILE, "mega-stepdir", None, ("mega-stepdir", 1_000_000)),
        (FILE, "uno-stepdir", None, ("uno-stepdir", 115_200)),  # the file's rate is that of another board
        (FILE, "uno-stepdir", 1_000_000, ("uno-stepdir", 1_000_000)),
    ],
)
def test_the_command_line_comes_before_the_file(
    file: BoardLink | None, board: str | None, baud: int | None, found: tuple[str, int] | None
) -> None:
    assert board_of(replace(trochia.load("reference-mill"), board=file), board, baud) == found


@pytest.fixture
def files(tmp_path: Path) -> tuple[str, str]:
    machine = trochia.load("reference-mill")
    axes = tuple(replace(axis, velocity=300.0, acceleration=2000.0) for axis in machine.axes)
    joints = tuple(replace(joint, pulse_rate=None) for joint in machine.joints)
    made = replace(machine, axes=axes, joints=joints, board=BoardLink(kind="uno-stepdir"))
    (tmp_path / "mill.toml").write_text(dumps(made), encoding="utf-8")
    (tmp_path / "fast.ngc").write_text(FAST)
    return str(tmp_path / "fast.ngc"), str(tmp_path / "mill.toml")


def test_check_and_plan_judge_the_file_s_board(files: tuple[str, str]) -> None:
    program, machine = files
    done = CliRunner().invoke(check.command, [program, "-m", machine, "--json"])
    assert done.exit_code == 1
    assert json.loads(done.stdout)["problems"][0]["message"].startswith("uno-stepdir: ")
    assert CliRunner().invoke(plan.command, [program, "-m", machine]).exit_code == 1
    other = CliRunner().invoke(check.command, [program, "-m", machine, "--board", "mega-stepdir", "--json"])
    assert json.loads(other.stdout)["problems"][0]["message"].startswith("mega-stepdir: ")


def test_the_twin_runs_what_the_board_could_not(files: tuple[str, str]) -> None:
    program, machine = files
    assert CliRunner().invoke(run.command, [program, "-m", machine, "--virtual", "-y"]).exit_code == 0


def test_a_board_that_is_none_is_one_message(files: tuple[str, str]) -> None:
    _, machine = files
    done = CliRunner().invoke(serve.command, ["-m", machine, "--backend", "simavr", "--board", "due"])
    assert done.exit_code == 2
    assert "no board is called 'due'" in done.output
