"""``trochia sweep`` as a user calls it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from trochia.cli.sweep import command
from trochia.errors import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

BIG = ["--motor", "QSH5718-55", "--supply", "24 V", "--current", "2.5 A"]


def test_a_motor_by_its_numbers(tmp_path: Path):
    csv, png = tmp_path / "t.csv", tmp_path / "t.png"
    result = CliRunner().invoke(command, [*BIG, "--points", "5", "--csv", str(csv), "-o", str(png), "--json"])
    assert result.exit_code == 0, result.output
    figures = json.loads(result.stdout)
    assert figures["excitation"] == "microstep-16"
    assert figures["current_A"] == 2.5
    assert 500 < figures["corner_rpm"] < 700
    assert len(figures["curve"]) == 5
    assert figures["files"] == [str(csv), str(png)]
    assert csv.read_text().splitlines()[0] == "speed_rpm,torque_Nm"
    assert png.read_bytes().startswith(b"\x89PNG")


def test_an_l293d_and_the_limits_on_the_twin():
    result = CliRunner().invoke(
        command, ["--motor", "SM-42BYG011-25", "--supply", "12 V", "--top", "150 rpm", "--points", "3", "--limits",
                  "exact", "--friction", "4 mN·m"]
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "SM-42BYG011-25, h-bridge at 12 V, two-phase" in result.output
    assert "pull-out speed on the twin: 25" in result.output


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "one of them"),
        ([*BIG, "-m", "laser"], "one of them"),
        (BIG[:2], "needs a supply"),
        ([*BIG, "--driver", "l/r"], "needs its resistor"),
        ([*BIG[:4], "--driver", "chopper"], "needs its current"),
        ([*BIG, "--inertia", "5 N"], "expected an inertia"),
        ([*BIG, "-o", "t.pdf"], "ends in .png or .svg"),
        ([*BIG, "--program", "x.ngc"], "does not exist"),
    ],
)
def test_what_does_not_fit_is_one_message(options: list[str], said: str):
    result = CliRunner().invoke(command, options)
    assert result.exit_code == 2
    assert said in result.output


def test_a_machine_without_a_motor_s_name_is_told_what_to_add():
    result = CliRunner().invoke(command, ["-m", "laser"])
    assert isinstance(result.exception, ConfigError)
    assert "library" in str(result.exception)
