"""``trochia excitation`` as a user calls it: the tables of the shield, directions, pictures, currents."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pytest
from click.testing import CliRunner

from trochia.cli.excitation import command
from trochia.errors import ConfigError, LimitError
from trochia.pulses.bridge_picture import STATES
from trochia.pulses.excitation_table import steps_of
from trochia.pulses.latch import serial_bits

if TYPE_CHECKING:
    from pathlib import Path

#: mode -> sectors, terminals, and the register's bytes of motor 1 and motor 2 (the shield's published bit map)
SHIELD = {
    "one-phase": ([0, 2, 4, 6], ["A+", "B+", "A-", "B-"], "04 02 08 10", "20 01 80 40"),
    "two-phase": ([1, 3, 5, 7], ["A+ B+", "A- B+", "A- B-", "A+ B-"], "06 0A 18 14", "21 81 C0 60"),
    "half-step": (list(range(8)), ["A+", "A+ B+", "B+", "A- B+", "A-", "A- B-", "B-", "A+ B-"],
                  "04 06 02 0A 08 18 10 14", "20 21 01 81 80 C0 40 60"),
}  # fmt: skip
RUN = ["two-phase", "--motor", "SM-42BYG011-25", "--supply", "9.4 V", "--speed", "90 rpm"]


def said(*options: str, code: int = 0) -> str:
    result = CliRunner().invoke(command, list(options))
    assert result.exit_code == code, result.output
    return result.output


def figures(*options: str) -> dict:
    return json.loads(said(*options, "--json"))


@pytest.mark.parametrize("mode", SHIELD)
@pytest.mark.parametrize("back", [False, True])
def test_the_tables_of_the_shield_in_both_directions(mode: str, *, back: bool):
    sectors, terminals, *latches = SHIELD[mode]
    rows = figures(mode, *["--back"] * back)["steps"]

    def way(of: list) -> list:
        return [of[0], *of[:0:-1]] if back else of

    assert [row["sector"] for row in rows] == way(sectors)
    assert [row["terminals"] for row in rows] == way(terminals)
    for motor, expected in zip("12", latches, strict=True):
        assert [row["latch"][motor] for row in rows] == way(list(bytes.fromhex(expected)))


def test_clockwise_and_back_as_the_text_names_them():
    assert [row["terminals"] for row in figures("one-phase", "--back")["steps"]] == ["A+", "B-", "A-", "B+"]


def test_the_text_has_the_bytes_and_the_bits_in_their_order():
    text = said("two-phase")
    for byte, other in (("06", "21"), ("0A", "81"), ("18", "C0"), ("14", "60")):
        bits = "".join(map(str, serial_bits(int(byte, 16))))
        assert any(line.split()[-3:] == [byte, other, bits] for line in text.splitlines())


def test_the_software_image_keeps_the_other_motors_bits():
    kept = [row["latch"]["1"] for row in figures("half-step", "--image", "0xC0")["steps"]]
    assert [byte & 0xE1 for byte in kept] == [0xC0] * 8
    assert [byte & 0x1E for byte in kept] == list(bytes.fromhex(SHIELD["half-step"][2]))


def test_sixteen_microsteps_are_the_shields_table_of_seventeen():
    rows = figures("microstep-table")["steps"]
    sine = [0, 25, 50, 74, 98, 120, 142, 162, 180, 197, 212, 225, 236, 244, 250, 254, 255]
    assert [row["duty"][1] for row in rows[:17]] == sine
    assert [row["duty"][0] for row in rows[:17]] == sine[::-1]
    assert [row["sector"] for row in rows] == [n // 8 for n in range(64)]


@pytest.mark.parametrize(("mode", "phases", "count"), [("one-phase", 3, 3), ("two-phase", 4, 4), ("half-step", 5, 10)])
def test_phases_that_are_on_or_off(mode: str, phases: int, count: int):
    steps = steps_of(mode, phases=phases)
    assert len(steps) == count
    turned = np.diff([step.angle for step in steps])
    np.testing.assert_allclose(turned, 2 * np.pi / count)
    assert steps[0].terminals == ("A" if mode != "two-phase" else "A B")
    assert "shifted out" not in said(mode, "--phases", str(phases))


def test_pictures_and_tables_are_written(tmp_path: Path):
    png, svg, csv = tmp_path / "a.png", tmp_path / "b.svg", tmp_path / "c.csv"
    assert f"wrote {csv}" in said("microstep-table", "-o", str(png), "--csv", str(csv))
    assert png.read_bytes().startswith(b"\x89PNG")
    assert len(csv.read_text().splitlines()) == 65
    text = said(*RUN, "-o", str(svg))
    assert "<svg" in svg.read_text()
    assert "the rotor is 52° (electrical) behind" in text
    said("half-step", "--phases", "4", "--back", "-o", str(svg))
    said("microstep-8", "--back", "-o", str(png))
    assert svg.read_bytes() == (said("half-step", "--phases", "4", "--back", "-o", str(svg)), svg.read_bytes())[1]


def test_the_bridge_is_drawn_and_its_ways_are_kirchhoffs(tmp_path: Path):
    svg = tmp_path / "bridge.svg"
    assert f"wrote {svg}" in said("--bridge", str(svg))
    assert "<svg" in svg.read_text()
    assert [state.voltage for state in STATES] == ["+V", "-V", "-V", "0"]
    for state in STATES:
        halves = [name for name in state.conducting if name[1] in "12"], [n for n in state.conducting if n[1] in "34"]
        assert [len(half) for half in halves] == [1, 1]  # in by one half, out by the other
        top = {name[1] in "13" for name in state.conducting}
        assert len(top) == (1 if state.voltage == "0" else 2)  # from rail to rail, or about one of them
        for (x0, y0), (x1, y1) in pairwise(state.way):
            assert (x0 == x1) != (y0 == y1)


def test_currents_by_their_numbers():
    found = figures(*RUN)["currents"]
    assert len(found["step"]) == len(found["current_A"]) == 4 * 48
    slower = figures(*RUN, "--series", "30 ohm")["currents"]
    assert np.abs(slower["current_A"]).max() < np.abs(found["current_A"]).max()


def test_without_a_mode_the_modes_are_listed():
    assert "1.414" in said()
    assert {row["mode"] for row in figures()["modes"]} >= {"one-phase", "two-phase", "half-step", "microstep-table"}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["two-phase", "--image", "1C0"], "expected a byte"),
        (["two-phase", "--image", "xy"], "expected a byte"),
        (["two-phase", "-o", "a.pdf"], "ends in .png or .svg"),
        (["two-phase", "--csv", "no/such/a.csv"], "no folder"),
        (["--bridge", "a.gif"], "ends in .png or .svg"),
        (["-o", "a.png"], "those of a MODE"),
        (RUN[:3], "need --motor, --supply and --speed"),
        ([*RUN, "--back"], "runs forwards"),
        ([*RUN, "--phases", "4"], "two phases"),
        ([*RUN, "--load-torque", "1 N"], "expected a torque"),
        (["two-phase", "--phases", "17"], "range"),
    ],
)
def test_what_does_not_fit_is_one_message(options: list[str], words: str):
    assert words in said(*options, code=2)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        (["two-phases"], ConfigError, "no excitation is called"),
        (["microstep-16", "--phases", "4"], ConfigError, "no distributor makes"),
        ([*RUN[:-1], "900 rpm", "--load-torque", "50 mN·m"], LimitError, "at 900 rpm on 9.4 V the motor has"),
    ],
)
def test_what_cannot_be_is_named(options: list[str], error: type[Exception], words: str):
    with pytest.raises(error, match=words):
        CliRunner().invoke(command, options, catch_exceptions=False)
