"""``trochia motors`` as a user calls it, and motors of one's own where a motor is named."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from trochia.cli.motors import command
from trochia.cli.sweep import command as sweep
from trochia.errors import ConfigError
from trochia.machine.motors import library, motor
from trochia.machine.motors.curves import corner_speed, pull_out_torque
from trochia.machine.motors.facts import derived, reach

if TYPE_CHECKING:
    from pathlib import Path

OWN = """
[motors.mine]
full_steps = 200
resistance = "2 ohm"
inductance = "4 mH"
current = "1.5 A"
holding_torque = "3 kg-cm"
inertia = "50 g.cm2"
"""


def said(*options: str, code: int = 0) -> str:
    result = CliRunner().invoke(command, list(options))
    assert result.exit_code == code, result.output
    return result.output


def figures(*options: str) -> dict:
    return json.loads(said(*options, "--json"))["motors"]


def test_the_list_has_every_motor_the_weakest_first():
    lines = said().splitlines()
    names = [line.split()[0] for line in lines[1:] if line.startswith("  ")]
    assert sorted(names) == sorted(library())
    torques = [motor(name).holding_torque for name in names]
    assert torques == sorted(torques)
    assert f"{len(library())} motors" in lines[-1]


def test_it_is_searched_as_one_types():
    assert set(figures("--find", "nema17")) == set(figures("--find", "NEMA 17")) > {"17HS4401"}
    assert set(figures("--find", "permanent")) == {"9904-112-35014"}
    assert all(row["holding_torque_Nm"] >= 1.0 for row in figures("--torque", "10.2 kgf·cm").values())
    assert "No motor is like that" in said("--find", "NEMA 99", code=1)


@pytest.mark.parametrize("name", library())
def test_what_is_derived_agrees_with_the_equations(name: str):
    row = motor(name)
    stepper, facts = row.parameters(), derived(row.parameters())
    assert facts["two_phase_Nm" if row.phases_on == 2 else "one_phase_Nm"] == pytest.approx(row.holding_torque)
    assert facts["back_emf_V_krpm"] == pytest.approx(stepper.torque_constant * 1000 * math.tau / 60)
    stiffness = stepper.teeth * stepper.torque_constant * stepper.current
    assert facts["resonance_Hz"] == pytest.approx(math.sqrt(stiffness / stepper.inertia) / math.tau)
    found = reach(stepper, 48.0)
    assert found.corner == pytest.approx(corner_speed(stepper, 48.0))
    half = 0.5 * stepper.torque_constant * stepper.current
    assert pull_out_torque(stepper, found.half, 48.0, current=stepper.current) == pytest.approx(half, rel=0.02)
    assert reach(stepper, 0.9 * stepper.resistance * stepper.current).corner is None


def test_one_motor_in_full_with_the_rule_of_the_root_of_two():
    text = said("SM-42BYG011-25", "--supply", "12 V", "--supply", "5 V")
    for words in ("K = 0.23 N·m/(√2 · 0.33 A) = 0.4928 N·m/A", "add up to √2", "K were 0.697", "38 g·cm²  assumed",
                  "read again on 2026-11-23", "NEMA 17, hybrid, 200 full steps a turn (1.8°)", "14 rpm"):  # fmt: skip
        assert words in text
    assert text.splitlines()[-4].split() == ["5", "V", "-", "-"]
    assert "not read again by anyone" in said("QSH5718-41")


def test_wiring_of_half_windings_as_the_table_of_wirings_says():
    half, series = (figures("SY42STH38-0406A", *options)["SY42STH38-0406A"] for options in ((), ("--wiring", "series")))
    assert series["derived"]["two_phase_Nm"] == pytest.approx(math.sqrt(2) * half["derived"]["two_phase_Nm"])
    assert series["derived"]["copper_heat_W"] == pytest.approx(half["derived"]["copper_heat_W"])


def test_ones_own_file_is_listed_shown_and_swept(tmp_path: Path):
    file = tmp_path / "my.toml"
    file.write_text(OWN)
    assert "mine" in said("--file", str(file))
    assert figures(f"{file}:mine")[f"{file}:mine"] == figures("mine", "--file", str(file))["mine"]
    text = said(str(file))
    assert "0.294" in text
    assert "source: not told" in text
    options = ["--motor", f"{file}:mine", "--supply", "24 V", "--current", "1.5 A", "--points", "3"]
    result = CliRunner().invoke(sweep, options)
    assert result.exit_code == 0, result.output
    assert "holds 0.208 N·m at rest" in result.output


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('"2 ohm"', '"-2 ohm"'), ["my.toml:4", 'resistance: must be above zero, not "-2 ohm"']),
        (('"4 mH"', '"4 H"'), ["my.toml:5", "0.1 to 200 mH would do", "Is it 4 mH, not 4 H?"]),
        (('"3 kg-cm"', '"3 N·m"'), ["my.toml:7", "Is it 3 kgf·cm (0.294 N·m)", "not 3 N·m?"]),
        (('"3 kg-cm"', '"42 N·m"'), ["Is it 42 N·cm (0.42 N·m) or 42 oz·in (0.297 N·m), not 42 N·m?"]),
        (('"3 kg-cm"', '"3 kg"'), ["expected a torque with its unit", "kg is a unit of mass"]),
        (("200", "0"), ["full_steps: must be above zero, not 0"]),
        (("200", "202"), ["200 or 204 would do"]),
        (('"1.5 A"', '"1500 A"'), ["Is it 1500 mA (1.5 A), not 1500 A?"]),
        (('"1.5 A"', "1.5"), ["expected a current with its unit"]),
        (('"50 g.cm2"', '"50 kg.cm2"'), ["my.toml:8", "Is it 50 g·cm², not 50 kg·cm²?"]),
        (("inertia", "interia"), ["did you mean inertia"]),
    ],
)
def test_absurd_values_are_one_message_with_place_number_and_what_would_do(
    tmp_path: Path, change: tuple[str, str], words: list[str]
):
    file = tmp_path / "my.toml"
    file.write_text(OWN.replace(*change))
    result = CliRunner().invoke(command, ["--file", str(file)])
    assert isinstance(result.exception, Exception)
    for each in words:
        assert each in str(result.exception)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["QSH5718-40"], r"did you mean QSH5718-41\? `trochia motors` lists its"),
        (["no-such.toml:mine"], "cannot read"),
    ],
)
def test_motors_that_are_not_there(options: list[str], words: str):
    with pytest.raises(ConfigError, match=words):
        CliRunner().invoke(command, options, catch_exceptions=False)


def test_a_file_with_several_wants_a_name(tmp_path: Path):
    file = tmp_path / "my.toml"
    file.write_text(OWN + OWN.replace("mine", "other"))
    with pytest.raises(ConfigError, match=r"has several motors\n.*mine, other"):
        CliRunner().invoke(command, [str(file)], catch_exceptions=False)
    with pytest.raises(ConfigError, match="did you mean mine"):
        CliRunner().invoke(command, [f"{file}:mime"], catch_exceptions=False)


def test_options_that_do_not_fit():
    assert "leave them" in said("17HS4401", "--find", "x", code=2)
    assert "--supply" in said("--supply", "24 A", code=2)
