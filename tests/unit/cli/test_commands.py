"""The command line as a user meets it: the real program, its exit codes, its JSON, its messages."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
CONTOUR = str(ROOT / "programs" / "contour.ngc")


def trochia(*args: str, stdin: str = "") -> subprocess.CompletedProcess[str]:
    code = "import sys; from trochia.cli import main; sys.argv[0] = 'trochia'; main()"
    return subprocess.run([sys.executable, "-c", code, *args], input=stdin, capture_output=True, text=True, check=False)


def test_help_lists_the_commands():
    done = trochia("--help")
    assert done.returncode == 0
    for command in ("check", "canon", "plan", "simulate", "interpolate", "profile", "sweep", "size", "machine"):
        assert f"  {command} " in done.stdout


@pytest.mark.parametrize(
    "command", ["check", "canon", "plan", "simulate", "interpolate", "profile", "sweep", "size", "machine"]
)
def test_every_command_has_help_with_an_example(command: str):
    done = trochia(command, "--help")
    assert done.returncode == 0
    assert "Example:" in done.stdout or "Examples:" in done.stdout


def test_help_does_not_load_numpy():
    code = (
        "import sys; from trochia.cli import group; group(['--help'], standalone_mode=False);"
        "print('numpy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "False"


def test_check_json_has_its_keys():
    done = trochia("check", CONTOUR, "-m", "xy-table", "--json")
    verdict = json.loads(done.stdout)
    assert done.returncode == 0
    assert verdict["ok"] is True
    assert verdict["time_s"] > 33  # 1319.713 mm at 40 mm/s, the nut's limit
    assert {p["code"] for p in verdict["problems"]} == {"feed-slowed"}
    assert set(verdict["problems"][0]) == {"severity", "code", "file", "line", "column", "message"}
    assert set(verdict["margins"]["X"]) == {"torque", "speed", "step_rate"}


def test_plan_json_has_its_keys():
    done = trochia("plan", CONTOUR, "-m", "xy-table", "--json")
    plan = json.loads(done.stdout)
    assert done.returncode == 0
    assert plan["time_s"] == pytest.approx(plan["motion_s"] + plan["dwell_s"] + plan["spindle_s"] + plan["tool_s"])
    assert (plan["feed_moves"], round(plan["feed_length_mm"], 3)) == (194, 1319.713)
    assert plan["peaks"]["X"]["velocity"] == pytest.approx(40.0, rel=1e-3)  # never above; on arcs a hair below
    assert plan["profile"] == "s-curve"  # the machine gives jerk
    assert plan["peaks"]["X"]["jerk"] == pytest.approx(2660.0, rel=1e-3)
    assert plan["extents"]["X"][0] == 0.0  # the start counts as motion
    assert len(plan["line_times"]) == 5


def test_simulate_writes_report_picture_and_recording(tmp_path: Path):
    done = trochia("simulate", CONTOUR, "-m", "xy-table", "-o", str(tmp_path / "out"), "--json")
    proof = json.loads(done.stdout)
    assert done.returncode == 0
    assert set(proof) > {"time_s", "following_error", "contour_error_mm", "lost_steps", "files"}
    assert Path(proof["files"]["report"]).read_text(encoding="utf-8").lower().startswith("<!doctype html>")
    assert Path(proof["files"]["picture"]).read_bytes().startswith(b"\x89PNG")
    # a servo follows as its loop lets it: late, but by less than the 1000 counts (of 4096 a mm) of the card's warning
    assert 1 / 4096 < proof["following_error"]["X"]["peak"] < 1000 / 4096


def test_simulate_tells_of_a_circle(tmp_path: Path):
    program = tmp_path / "round.ngc"
    program.write_text("G21 G90 G17\nM3 S1\nF1200\nG0 X10 Y0\nG2 X10 Y0 I-10 J0\nG2 X10 Y0 I-10 J0\nM2\n")
    done = trochia("simulate", str(program), "-m", "xy-table", "-o", str(tmp_path / "out"), "--circle", "--json")
    test = json.loads(done.stdout)["circle"]
    assert test["radius_mm"] == pytest.approx(10, abs=1e-3)
    assert 0 < test["circular_deviation_mm"] < 0.1
    assert {round(spike["angle_deg"]) for spike in test["spikes"]} <= {0, 90, 180, 270, 360}
    assert (tmp_path / "out" / "circle.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("args", "stdin", "code", "words"),
    [
        (("check", "-", "-m", "xy-table"), "G21 F100\nG1 X1 Q\nM2\n", 1, ["<stdin>:2:", "^"]),
        (("check", "-", "-m", "xy-table"), "", 1, ["empty"]),
        (("check", "-", "-m", "xy-table"), "G21\x00\n", 1, ["NUL"]),
        (("plan", "-", "-m", "xy-table"), "G21 F100\nG1 X999\nM2\n", 1, ["<stdin>:2:", "beyond its travel"]),
        (("simulate", "-", "-m", "xy-table"), "G21 F100\nG1 X1\n", 1, ["M2"]),
        (("check", "-", "-m", "no-such"), "M2\n", 2, ["no-such", "xy-table"]),
        (("check", "/no/such.ngc", "-m", "xy-table"), "", 2, ["/no/such.ngc"]),
        (("check", CONTOUR), "", 2, ["--machine"]),
        (("plan", "-", "-m", "xy-table", "--at", "Xten"), "M2\n", 2, ["X10Y-5"]),
        (("plan", "-", "-m", "xy-table", "--profile", "no"), "G0X1\nM2\n", 1, ["no", "trapezoid"]),
        (("simulate", "-", "-m", "xy-table", "--rate", "7"), "M2\n", 2, ["1 ms"]),
        (("frobnicate",), "", 2, ["frobnicate"]),
    ],
)
def test_a_mistake_is_one_message_and_an_exit_code(args: tuple[str, ...], stdin: str, code: int, words: list[str]):
    done = trochia(*args, stdin=stdin)
    said = done.stdout + done.stderr
    assert done.returncode == code, said
    assert "Traceback" not in said
    for word in words:
        assert word in said


def test_a_refused_program_leaves_no_files(tmp_path: Path):
    done = trochia("simulate", "-", "-m", "xy-table", "-o", str(tmp_path / "out"), stdin="G21 F100\nG1 X999\nM2\n")
    assert done.returncode == 1
    assert list(tmp_path.iterdir()) == []
