"""The sketches in a real terminal, with somebody at the keys."""

from __future__ import annotations

import os
import pty
import re
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest

SKETCHES = Path(__file__).parents[3] / "examples" / "steppers"
NUMBERED = sorted(SKETCHES.glob("[0-9][0-9]_*.py"))
CTRL_C = "\x03"
PATIENCE = 60.0  # s without a word from a sketch

Dialogue = list[tuple[str, str]]


def converse(name: str, dialogue: Dialogue, *options: str) -> str:
    """Run a sketch at its own terminal; each pair is what to wait for and what to type then.  Return what it said."""
    (script,) = SKETCHES.glob(f"{name}_*.py")
    ours, theirs = pty.openpty()
    command = [sys.executable, str(script), "--pace", "0", *options]
    with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, close_fds=True) as process:
        os.close(theirs)
        seen, heard = "", 0
        try:
            for expected, answer in [*dialogue, (r"(?!)", "")]:
                while not (found := re.search(expected, seen[heard:])):
                    assert select.select([ours], [], [], PATIENCE)[0], seen
                    try:
                        part = os.read(ours, 65536)
                    except OSError:  # the other end is closed
                        part = b""
                    if not part:
                        break
                    seen += part.decode().replace("\r\n", "\n")
                if found:
                    heard += found.end()
                    if answer == CTRL_C:  # it is no controlling terminal, which would make this of it
                        process.send_signal(signal.SIGINT)
                    else:
                        os.write(ours, answer.encode())
        finally:
            os.close(ours)
            process.wait(timeout=PATIENCE)
    assert process.returncode == 0, seen
    return seen


def test_there_are_the_fifteen_and_the_controllers_demonstration():
    assert [path.name[:2] for path in NUMBERED] == [f"{n:02}" for n in range(1, 17)]


@pytest.mark.parametrize("script", NUMBERED, ids=lambda path: path.stem)
def test_a_sketch_says_what_was_mended(script: Path):
    text = script.read_text()
    assert text.startswith('"""')
    assert "Mended:" in text.split('"""')[1]
    assert len(text.splitlines()) <= 70


@pytest.mark.parametrize(
    ("name", "seconds", "expected"),
    [
        ("01", "7", "1 turn\n2 turns\nSwitched off after 7.005 s."),
        ("02", "29", "turn 5, released: windings shorted, register 00\nturn 1, released"),
        ("03", "18", "SINGLE: 180 degrees and back\nDOUBLE: 180 degrees and back"),
    ],
)
def test_endless_ones_until_the_power_goes(name: str, seconds: str, expected: str):
    assert expected in converse(name, [], "--seconds", seconds)


def test_interleave_turns_half_as_far():
    assert "INTERLEAVE: 90 degrees and back\nMICROSTEP: 180" in converse("03", [], "--seconds", "60")


def test_one_that_is_switched_off_by_hand():
    said = converse("01", [("2 turns", "q")])
    assert re.search(r"Stopped and released after \d+", said)


@pytest.mark.parametrize(
    ("name", "word", "again"), [("04", "at 360 degrees", "at 720 degrees"), ("05", "turn 5", "turn 5")]
)
def test_reset_repeats(name: str, word: str, again: str):
    said = converse(name, [(word, ""), ("r repeats", "xr"), (again, ""), ("r repeats", "q")])
    assert "Stopped and released" in said


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("06", "9 turns counter-clockwise in 12.00 s, 45.0 rpm"),
        ("10", "above 200 rpm\n3000 steps in 7.000 s"),
        ("13", "1800 steps, 9 turns, 12.00 s"),
        ("14", "600 steps/s at step 120\n2000 steps in 3.733 s"),
    ],
)  # fmt: skip
def test_moves_that_end(name: str, expected: str):
    assert expected in converse(name, [])


@pytest.mark.parametrize(("name", "kind", "first"), [("07", "pull-out", "150"), ("08", "start/stop", "140")])
def test_the_searches_end_where_the_motor_does(name: str, kind: str, first: str):
    """Exact delays allow more than whole milliseconds, as delays of 1 and 2 ms in turn jerk the rotor."""
    found = [
        int(re.search(rf"{kind} speed (\d+) rpm", converse(name, [], "--rpm", first, *options))[1])  # type: ignore[index]
        for options in ((), ("--exact",))
    ]
    assert int(first) < found[0] < found[1] <= 350


def test_a_first_speed_that_is_too_fast_is_no_limit_found():
    said = converse("07", [], "--rpm", "400")
    assert re.search(r"\d+ steps lost at the first speed already: begin below 400 rpm", said)
    assert "pull-out speed" not in said


def test_the_rotor_is_told_of():
    """1000 steps back in whole milliseconds at 300 rpm, from rest: the twin cannot follow, and that is told."""
    said = converse("09", [("Enter Speed", "60\n"), ("no steps lost", "-300\n"), (r"-\d+ steps lost", "q")])
    assert "rotor at 1799." in said.replace("1800.", "1799.")
    assert re.search(r"of 0\.0 degrees|of -?0\.9 degrees", said)


def test_ctrl_c_stops_and_releases():
    said = converse("01", [("1 turn", CTRL_C)], "--pace", "200")
    assert "Stopped and released after" in said
    assert "Traceback" not in said


def test_what_is_typed_is_shown_and_taken_back():
    said = converse("09", [("Enter Speed", "6x\x7f0\n"), ("1000 steps clockwise", "q")])
    assert "6x" in said


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--pace", "-1"), "--pace must be 0 or more"),
        (("--pace", "nan"), "--pace must be 0 or more"),
        (("--seconds", "0"), "--seconds must be more than 0"),
        (("--rpm", "0"), "--rpm must be from 1 to 1000"),
        (("--port", "/dev/x"), "go together"),
        (("--backend", "simavr", "--pace", "0.5"), "real time"),
        (("--backend", "avr", "--port", "/dev/not-there"), "/dev/not-there is not there"),
        (("--picture", "/not/there/p.png", "--seconds", "0.1"), "/not/there"),
    ],
)
def test_options_that_cannot_be_are_named(options: tuple[str, ...], expected: str):
    done = subprocess.run(
        [sys.executable, str(NUMBERED[0]), "--pace", "0", *options],
        capture_output=True, text=True, check=False, input="", timeout=PATIENCE,
    )  # fmt: skip
    assert done.returncode in {1, 2}
    assert expected in done.stderr
    assert "Traceback" not in done.stderr


def test_a_picture_of_what_ran(tmp_path: Path):
    assert "Drawn to" in converse("14", [], "--picture", str(tmp_path / "ramp.png"))
    assert (tmp_path / "ramp.png").read_bytes().startswith(b"\x89PNG")


def test_a_speed_by_number():
    said = converse(
        "09",
        [("Enter Speed", "60\n"), (r"1000 steps clockwise, 5\.000 s", ""), ("Enter Speed", "-120\n"),
         (r"1000 steps counter-clockwise, 7\.500 s", ""), ("Enter Speed", "fast\n"), ("'fast' is no whole number", ""),
         ("Enter Speed", "70000\n"), ("at most 1000 rpm", ""), ("Enter Speed", "0\n"), ("0\nEnter Speed", "q")],
    )  # fmt: skip
    assert said.count("Enter Speed") == 6


def test_a_key_turns_round():
    said = converse(
        "11", [("motor_set", "a"), ("97", "Z"), (r"90\nclockwise, 6\.000 s", "Z"), ("counter-clockwise", "q")]
    )
    assert "90\ncounter-clockwise, 12.000 s" in said


def test_commands_one_after_another():
    said = converse(
        "12",
        [("Commands", "S1A1D99999999999999999S"), ("must lie within", "S450A300D800S\r\n"),
         (r"at 800, 3\.278 s", "S450A300D800S"),
         ("where it stands", "S600A900D-100S"), ("at -100", "S0A300D5S"), ("is no command", "S450A300D8xS"),
         ("is no command", "q")],
    )  # fmt: skip
    assert "MAXSPEED = 450 steps/s\nACCEL = 300 steps/s²\nDIST = 800 steps\nat 800" in said


def test_the_ramps_own_report():
    said = converse("15", []).splitlines()[1:]  # below the heads of the columns
    rows = [tuple(map(float, line.split())) for line in said[:200]]
    assert [row[0] for row in rows[:5]] == [7.69, 14.22, 20.02, 25.28, 30.14]
    assert rows[199][0] == 378.30
    assert rows[0][1] == 25.82  # √(2/3000)
    assert said[200] == "400 steps in 0.832 s"


def test_keys_choose_the_controllers_states():
    said = converse("16", [(r"n 210, n1 300, n2 -210", "ARDS"), ("DONE!", "q")])
    assert "c 1577.89, c0 30929.00 us" in said
    assert re.search(r"Running...\naccelerate: 210 .*\nrun: 390 .*\nbrake: 600 steps made, 1.5796 s\nDONE!", said)
