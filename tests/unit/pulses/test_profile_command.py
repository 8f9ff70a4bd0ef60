"""``trochia profile`` as a user meets it."""

from __future__ import annotations

import csv
import json
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from trochia.cli import exit_code
from trochia.cli.profile import command
from trochia.errors import TrochiaError
from trochia.pulses.ramps import RAMPS

if TYPE_CHECKING:
    from pathlib import Path

    from click.testing import Result

MOVE = ("--steps", "400", "--speed", "200 rpm", "--acceleration", "100 rad/s2")


def run(*args: str) -> Result:
    return CliRunner().invoke(command, args)


def test_json_has_its_keys():
    done = run(*MOVE, "--law", "austin", "--law", "exact", "--json")
    told = json.loads(done.stdout)
    assert done.exit_code == 0
    assert (told["law"], told["steps"], len(told["table"])) == ("austin", 400, 400)
    assert told["time_s"] == pytest.approx(0.7921, abs=5e-5)
    assert told["verdict"]["ok"] is True
    assert list(told["table"][0]) == [
        "time_s", "delay_s", "n", "elapsed_ticks", "ticks", "speed_rad_s", "speed_rpm", "speed_steps_s",
    ]  # fmt: skip
    assert [other["law"] for other in told["others"]] == ["exact"]


def test_table_verdict_and_remedy():
    done = run(*MOVE, "--require", "0.7 s", "--law", "austin")
    assert done.exit_code == 1
    for words in ("Austin's recursion: 400 steps in 0.792 s", "16945", "It will not do", "186.5 rad/s²"):
        assert words in done.stdout


def test_files(tmp_path: Path):
    table, picture = tmp_path / "t.csv", tmp_path / "p.png"
    done = run(*MOVE, "--csv", str(table), "--plot", str(picture))
    assert done.exit_code == 0
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["n"] for row in rows] == [str(n) for n in range(400)]
    assert float(rows[-1]["time_s"]) == pytest.approx(0.809440, abs=5e-7)  # 0.6 + 0.2094: N/v + v/a
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_torque_curve_alone_chooses_the_law(tmp_path: Path):
    curve = tmp_path / "curve.csv"
    curve.write_text("speed_rpm,torque_Nm\n0,0.23\n100,0.2\n200,0.1\n", encoding="utf-8")
    args = ("--steps", "400", "--speed", "190 rpm", "--torque-curve", str(curve), "--inertia", "60 g·cm²")
    done = run(*args, "--load-torque", "0.05 N·m", "--json")
    told = json.loads(done.stdout)
    assert (done.exit_code, told["law"], told["acceleration_steps_s2"]) == (0, "torque", None)


def test_a_time_box_is_its_own_requirement():
    done = run("--steps", "200", "--speed", "670 steps/s", "--acceleration", "120 rad/s²", "--time-box", "0.42 s")
    assert done.exit_code == 0
    assert "0.42 s lies within 0.42 s ±5 %" in done.stdout


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("--steps", "0", "--speed", "1 rpm"), "--steps"),
        (("--steps", "9", "--speed", "0 rpm"), "more than 0"),
        (("--steps", "9", "--speed", "-3 steps/s"), "more than 0"),
        (("--steps", "9", "--speed", "3 mm/s"), "670 steps/s"),
        (("--steps", "9", "--speed", "three"), "670 steps/s"),
        (("--steps", "9", "--speed", "9 rpm", "--acceleration", "9 rpm"), "100 rad/s²"),
        ((*MOVE, "--law", "cubic"), ", ".join(RAMPS)),
        ((*MOVE, "--tolerance", "0"), "100 %"),
        ((*MOVE, "--tolerance", "few"), "5 %"),
        ((*MOVE, "--inertia", "3 kg"), "inertia"),
        ((*MOVE, "--plot", "/no/such/folder/p.png"), "there is no folder"),
        ((*MOVE, "--torque-curve", "/no/such.csv"), "/no/such.csv"),
    ],
)
def test_a_mistake_on_the_command_line(args: tuple[str, ...], words: str):
    done = run(*args)
    assert done.exit_code == 2
    assert words in done.output


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("--steps", "9", "--speed", "9 rpm"), "needs an acceleration"),
        ((*MOVE, "--start-stop", "10 rpm"), "the first step is made at"),
        ((*MOVE, "--time-box", "0.5 s"), "800 steps/s"),
        (("--steps", "9", "--speed", "1e9 rpm", "--acceleration", "1 rad/s2"), "timer's clock"),
    ],
)
def test_what_the_motor_cannot_do(args: tuple[str, ...], words: str):
    done = run(*args)
    assert isinstance(done.exception, TrochiaError)
    assert exit_code(done.exception) == 1
    assert words in str(done.exception)
    assert done.exception.hint
