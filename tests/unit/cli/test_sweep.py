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

    from click.testing import Result

BIG = ["--motor", "QSH5718-55", "--supply", "24 V", "--current", "2.5 A"]


def run(*args: str) -> Result:
    return CliRunner().invoke(command, args)


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
    assert "pull-out speed on the twin: 29" in result.output


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


def test_supplies_and_motors_over_each_other(tmp_path: Path):
    """Twice the supply drives the full current to some twice the speed; the torque at rest stays."""
    picture = tmp_path / "both.svg"
    done = run("--motor", "QSH5718-55", "--supply", "12 V", "--current", "2.5 A", "--also-supply", "24 V",
               "--also-motor", "QSH5718-79", "-o", str(picture), "--json")  # fmt: skip
    told = json.loads(done.stdout)
    twice, stronger = told["others"]
    assert done.exit_code == 0
    assert twice["holding_torque_Nm"] == told["holding_torque_Nm"] < stronger["holding_torque_Nm"]
    assert twice["corner_rpm"] > 2 * told["corner_rpm"]
    ends = {row["curve"][-1]["speed_rpm"] for row in (told, twice, stronger)}
    assert len(ends) == 1  # all over the same speeds
    assert picture.stat().st_size > 10_000


def test_measured_torque_has_the_friction_that_is_dragged_along():
    args = ("--motor", "QSH5718-55", "--supply", "24 V", "--current", "2.5 A", "--top", "120 rpm", "--points", "2",
            "--friction", "0.05 N·m", "--measure", "--json")  # fmt: skip
    for row in json.loads(run(*args).stdout)["curve"]:
        assert row["measured_Nm"] == pytest.approx(row["pull_out_Nm"], rel=0.1)


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("-m", "belt-stage", "--also-supply", "48 V"), "give --motor"),
        (("--motor", "QSH5718-55", "--supply", "9 V", "--current", "1 A", *("--also-supply", "24 V") * 6), "At most 5"),
    ],
)
def test_what_cannot_be_drawn_besides(args: tuple[str, ...], words: str):
    done = run(*args)
    assert done.exit_code == 2
    assert words in done.output
