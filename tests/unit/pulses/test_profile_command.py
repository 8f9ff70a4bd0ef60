"""``trochia profile`` as a user meets it."""

from __future__ import annotations

import csv
import json
import re
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from trochia.cli import exit_code
from trochia.cli.profile import command
from trochia.cli.sweep import command as sweep_command
from trochia.errors import TrochiaError
from trochia.pulses.ramps import RAMPS

if TYPE_CHECKING:
    from pathlib import Path

    from click.testing import Result

MOVE = ("--steps", "400", "--speed", "200 rpm", "--acceleration", "100 rad/s2")


def run(*args: str) -> Result:
    return CliRunner().invoke(command, args)


def run_sweep(*args: str) -> Result:
    return CliRunner().invoke(sweep_command, args)


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


SHIELD = ("--motor", "SM-42BYG011-25", "--supply", "12 V", "--friction", "4 mN·m", "--inertia", "100 g·cm²")
TYPED = ("--motor", "1.7 A, 1.65 ohm, 3.2 mH, 44 N·cm, 68 g·cm²", "--supply", "12 V", "--current", "1 A",
         "--travel-per-turn", "40 mm", "--mass", "0.5 kg", "--friction", "3 N")  # fmt: skip


def test_one_command_tells_all_of_a_motor():
    done = run(*SHIELD, "--move", "2 turns", "--speed", "150 rpm", "--acceleration", "100 rad/s2")
    assert done.exit_code == 0
    for words in ("two-phase, 0.276 A a phase", "A+B+ A-B+ A-B- A+B-", "starts       yes", "follows      yes",
                  "% left, 30% wanted", "stalls", "no step is lost"):  # fmt: skip
        assert words in done.stdout


def test_a_typed_motor_on_a_belt_in_millimetres():
    move = ("--move", "100 mm", "--speed", "200 mm/s", "--acceleration", "3000 mm/s2", "--json")
    told = json.loads(run(*TYPED, *move).stdout)
    assert told["steps"] == 100 / 40 * 3200
    assert told["peak_steps_s"] == pytest.approx(200 / 40 * 3200)
    assert told["acceleration_steps_s2"] == pytest.approx(3000 / 40 * 3200)
    assert told["time_s"] == pytest.approx(100 / 200 + 200 / 3000)
    motor = told["motor"]
    assert (motor["starts"], motor["follows"], motor["twin"]["lost_steps"]) == (True, True, 0)
    arm = 0.04 / 6.283185307
    needed = (68e-7 + 0.5 * arm**2) * 3.0 / arm
    curve = json.loads(run_sweep(*TYPED, "--top", "300 rpm", "--points", "2", "--json").stdout)["curve"][-1]
    assert 1 - motor["margin"] == pytest.approx(needed / (curve["pull_out_Nm"] - 3.0 * arm), rel=0.02)


@pytest.mark.parametrize(
    ("args", "option", "pattern"),
    [
        ((*MOVE, "--start-stop", "10 rpm"), "--acceleration", r"acceleration of ([\d.]+) steps/s²"),
        ((*MOVE, "--start-stop", "10 rpm"), "--acceleration", r"\(([\d.]+) rad/s²\) would do"),
        ((*MOVE, "--law", "austin", "--start-stop", "10 rpm"), "--acceleration", r"acceleration of ([\d.]+) steps/s²"),
        ((*MOVE, "--law", "library", "--start-stop", "10 rpm"), "--acceleration", r"([\d.]+) steps/s²"),
        (
            ("--steps", "1", "--speed", "999 rpm", "--acceleration", "1e9 steps/s²", "--start-stop", "70 rpm"),
            "--acceleration",
            r"acceleration of ([\d.]+) steps/s²",
        ),
        ((*MOVE, "--time-box", "0.5 s"), "--time-box", r"\n\s*([\d.]+) s would do"),
        ((*MOVE, "--time-box", "0.65 s"), "--acceleration", r"([\d.]+) steps/s² \([\d.]+ rad/s²\) up"),
        ((*MOVE, "--time-box", "0.7 s"), "--time-box", r"acceleration asked for, ([\d.]+) s"),
        ((*MOVE[:4], "--time-box", "0.65 s", "--start-stop", "20 rpm"), "--time-box", r"\n\s*([\d.]+) s would do"),
        (("--steps", "9", "--speed", "1e9 rpm", "--acceleration", "1 rad/s2"), "--speed", r"At most ([\d.]+) steps/s"),
    ],
)
def test_the_number_that_is_offered_does(args: tuple[str, ...], option: str, pattern: str):
    """What a refusal names is typed in, in its unit, and is not refused."""
    refused = run(*args)
    assert isinstance(refused.exception, TrochiaError)
    found = re.search(pattern, str(refused.exception))
    assert found is not None, str(refused.exception)
    assert run(*_with(args, option, found.group(1) + _unit(option, pattern))).exit_code == 0


@pytest.mark.parametrize(
    ("args", "option", "pattern"),
    [
        ((*MOVE, "--require", "0.7 s"), "--acceleration", r"With ([\d.]+) steps/s²"),
        ((*MOVE, "--require", "0.7 s", "--law", "austin"), "--acceleration", r"With ([\d.]+) steps/s²"),
        ((*MOVE, "--require", "2 s"), "--acceleration", r"With ([\d.]+) steps/s²"),
        (("--steps", "40", *MOVE[2:], "--require-speed", "200 rpm"), "--acceleration", r"With ([\d.]+) steps/s²"),
        (("--steps", "40", *MOVE[2:], "--require-speed", "200 rpm", "--law", "austin"), "--acceleration",
         r"With ([\d.]+) steps/s²"),
        ((*TYPED, "--no-prove", *MOVE[:2], "--speed", "150 rpm", "--acceleration", "20000 rad/s2"), "--acceleration",
         r"with an acceleration of ([\d.]+) steps/s²"),
    ],
)  # fmt: skip
def test_the_remedy_that_is_told_does(args: tuple[str, ...], option: str, pattern: str):
    told = run(*args)
    assert told.exit_code == 1
    found = re.search(pattern, told.stdout)
    assert found is not None, told.stdout
    assert run(*_with(args, option, found.group(1) + _unit(option, pattern))).exit_code == 0


def _unit(option: str, pattern: str) -> str:
    """Return the unit of the number that a pattern takes."""
    if option == "--acceleration":
        return " rad/s²" if r") rad/s²\)" in pattern else " steps/s²"
    return " s" if option == "--time-box" else " steps/s"


def _with(args: tuple[str, ...], option: str, value: str) -> tuple[str, ...]:
    """Return a command with an option set anew."""
    if option not in args:
        return (*args, option, value)
    at = args.index(option)
    return (*args[: at + 1], value, *args[at + 2 :])


def test_overlays_of_accelerations_and_lengths(tmp_path: Path):
    picture = tmp_path / "two.svg"
    args = ("--steps", "350", "--steps", "600", "--speed", "190 rpm", "--acceleration", "30 rad/s2", "--acceleration",
            "60 rad/s2", "--law", "austin", "-o", str(picture), "--json")  # fmt: skip
    told = json.loads(run(*args).stdout)
    found = [
        (one["steps"], round(one["acceleration_steps_s2"] * 2 * 3.14159265 / 200)) for one in [told, *told["others"]]
    ]
    assert found == [(350, 30), (350, 60), (600, 30), (600, 60)]
    assert "350 steps, 60 rad/s2" in picture.read_text(encoding="utf-8") or picture.stat().st_size > 10_000


def test_a_chip_s_timer():
    """At 16 MHz undivided 16 bits hold no less than 244 steps/s; by 8, 30.5: the move's first step is at 39.9."""
    done = run(*MOVE, "--chip-clock", "16 MHz", "--json")
    told = {one["division"]: one for one in json.loads(done.stdout)["timer"]}
    assert [division for division, one in told.items() if one["fits"]] == [8, 64, 256, 1024]
    assert told[8]["longest_ticks"] == round(16e6 / 8 * (2 * 2 * 3.141592653589793 / 200 / 100) ** 0.5)
    assert "<- the finest" in run(*MOVE, "--chip-clock", "16 MHz").stdout
    slow = run("--steps", "9", "--speed", "9 rpm", "--acceleration", "1 rad/s2")
    assert "does not fit 16 bits" in slow.stdout
    clock = re.search(r"at most ([\d.]+) kHz", slow.stdout)
    assert clock is not None
    fits = run("--steps", "9", "--speed", "9 rpm", "--acceleration", "1 rad/s2", "--clock", f"{clock.group(1)} kHz")
    assert "does not fit" not in fits.stdout


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (("--motor", "1.7 A, 1.65 ohm", "--supply", "24 V", *MOVE), "inductance, holding torque, inertia is missing"),
        (("--motor", "1.7 A, 1.65 ohm, 2 A, 3 mH", "--supply", "24 V", *MOVE), "second current"),
        (("--motor", "1.7 A, 3 apples", "--supply", "24 V", *MOVE), "3 apples"),
        (("--motor", "QSH5718-55", "--supply", "24 V", "--mass", "2 kg", *MOVE), "--travel-per-turn"),
        (("--motor", "QSH5718-55", "--supply", "24 V", "--friction", "2 N", *MOVE), "--travel-per-turn"),
        (("--motor", "QSH5718-55", "--supply", "24 V", "--steps-per-turn", "77", *MOVE), "not 77"),
        (("--motor", "QSH5718-55", "--supply", "24 V", "--margin", "100 %", *MOVE), "no torque"),
        (("--motor", "QSH5718-55", *MOVE), "--supply"),
        (("--supply", "24 V", *MOVE), "needs the --motor"),
        (("--prove", *MOVE), "needs a motor"),
        (("--speed", "9 rpm"), "length of the move"),
        (("--move", "9 mm", "--speed", "9 rpm"), "--travel-per-turn"),
    ],
)
def test_a_motor_told_wrong(args: tuple[str, ...], words: str):
    done = run(*args)
    assert done.exit_code == 2
    assert words in done.output


@pytest.mark.parametrize(
    ("name", "words"), [("QSH5718-56", "QSH5718-55"), ("none.toml", "none.toml"), ("?", "68 g·cm²")]
)
def test_a_motor_that_there_is_not(name: str, words: str):
    done = run("--motor", name, "--supply", "24 V", *MOVE)
    assert isinstance(done.exception, TrochiaError)
    assert words in str(done.exception)


def test_absurd_catalogue_values_name_what_would_do():
    """68 kg·cm² typed for g·cm², and what the message offers is taken."""
    absurd = run(*(arg.replace("68 g·cm²", "68 kg·cm²") for arg in TYPED), "--move", "1 turn", *MOVE[2:])
    assert isinstance(absurd.exception, TrochiaError)
    offered = re.search(r"Is it (\d+ g·cm²)", str(absurd.exception))
    assert offered is not None
    args = (arg.replace("68 g·cm²", offered.group(1)) for arg in TYPED)
    assert run(*args, "--move", "1 turn", "--speed", "100 rpm", "--acceleration", "100 rad/s2").exit_code == 0


def test_a_file_of_motors(tmp_path: Path):
    rows = tmp_path / "mine.toml"
    one = """full_steps = 200\nresistance = "1.65 ohm"\ninductance = "3.2 mH"\ncurrent = "1.7 A"
holding_torque = "44 N·cm"\ninertia = "68 g·cm²"\nsource = "its label"\nchecked = false\n"""
    rows.write_text(f"[motors.small]\n{one}", encoding="utf-8")
    rest = (*TYPED[2:], "--move", "100 mm", "--speed", "200 mm/s", "--acceleration", "3000 mm/s2", "--json")
    by_file, typed = (json.loads(run("--motor", text, *rest).stdout) for text in (str(rows), TYPED[1]))
    assert by_file["motor"]["name"].startswith("mine.toml, chopper")
    assert by_file["motor"]["margin"] == typed["motor"]["margin"]
    rows.write_text(f"[motors.small]\n{one}[motors.large]\n{one}", encoding="utf-8")
    assert "mine.toml:NAME" in str(run("--motor", str(rows), *rest).exception)
    assert run("--motor", f"{rows}:large", *rest).exit_code == 0


def test_a_controller_s_own_times_lie_over_the_theory(tmp_path: Path):
    """What a table says the steps' times are, read back in milliseconds, is the profile again."""
    table, times = tmp_path / "table.csv", tmp_path / "times.txt"
    run(*MOVE, "--csv", str(table))
    with table.open(encoding="utf-8") as file:
        rows = [float(row["time_s"]) for row in csv.DictReader(file)]
    times.write_text("time_ms\n" + "\n".join(f"{1e3 * time:.9g}" for time in rows), encoding="utf-8")
    told = json.loads(run(*MOVE, "--against", str(times), "-o", str(tmp_path / "over.png"), "--json").stdout)
    (measured,) = told["others"]
    assert (measured["law"], measured["steps"], measured["acceleration_steps_s2"]) == ("measured", 400, None)
    assert measured["time_s"] == pytest.approx(told["time_s"], rel=1e-8)
    assert measured["peak_steps_s"] == pytest.approx(told["peak_steps_s"], rel=1e-4)
    assert run(*MOVE, "--against", str(times)).exit_code == 0
    with_motor = json.loads(run(*SHIELD, *MOVE, "--against", str(times), "--json").stdout)
    assert with_motor["others"][0]["motor"]["margin"] == pytest.approx(with_motor["motor"]["margin"], abs=0.01)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", 1, "time_ms"),
        ("seconds\n1\n", 1, "time_ms"),
        ("time_s\n0.1\nx\n", 3, "'x'"),
        ("time_s\n0.2\n0.2\n", 3, "does not rise"),
        ("time_s\n", 1, "1 to 1000000"),
    ],
)
def test_times_that_are_none(tmp_path: Path, text: str, line: int, words: str):
    times = tmp_path / "times.txt"
    times.write_text(text, encoding="utf-8")
    refused = run(*MOVE, "--against", str(times)).exception
    assert isinstance(refused, TrochiaError)
    assert f"times.txt:{line}" in str(refused)
    assert words in str(refused)


def test_time_and_steps_to_a_speed(tmp_path: Path):
    """v/a and v²/2a; and, of a published torque curve, the time with the load in it all the way."""
    done = run(*MOVE, "--require-speed", "100 rpm")
    assert "reached in 104.7 ms, 17.45 steps; to rest in 104.7 ms, 17.45 steps" in done.stdout
    curve = tmp_path / "curve.csv"
    curve.write_text("speed_steps_s,torque_Nm\n100,0.35\n100.000001,0.351\n435,0.09975\n", encoding="utf-8")
    args = ("--steps", "4000", "--steps-per-turn", "24", "--torque-curve", str(curve), "--load-torque", "0.1 N·m",
            "--inertia", "2e-4 kg·m²", "--speed", "400 steps/s", "--require-speed")  # fmt: skip
    assert "reached in 20.94" in run(*args, "100 steps/s").stdout
    assert "reached in 45.73" in run(*args, "200 steps/s").stdout


@pytest.mark.parametrize("law", [name for name in RAMPS if name != "torque"])
def test_braking_twice_as_hard_takes_half_the_steps(law: str):
    told = run(*MOVE, "--deceleration", "200 rad/s2", "--law", law, "--require-speed", "199 rpm").stdout
    up, down = (float(text) for text in re.findall(r"ms, ([\d.]+) steps", told))
    assert up == pytest.approx(2 * down, abs=2.5)
