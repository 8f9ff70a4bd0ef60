"""The commands ``identify`` and ``tune``: what they say, and what they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from trochia.cli import identify, tune
from trochia.errors import ConfigError, RecordingError

HEX = Path(__file__).parents[2] / "golden" / "servo" / "leadscrew-step-log.hex"


def run(command, *words: str) -> str:  # type: ignore[no-untyped-def]
    """Return what a command prints; its errors are raised as the command line's main would see them."""
    return CliRunner().invoke(command, words, catch_exceptions=False, standalone_mode=False).output


def test_the_leadscrew_s_log_gives_its_pole() -> None:
    found = json.loads(run(identify.command, str(HEX), "--json"))
    assert found["parameters"]["pole"] == pytest.approx(74.29, rel=0.02)
    assert found["uncertainty"]["pole"] > 0.0
    assert any("by the check sum the lost one is" in problem for problem in found["problems"])


def test_a_step_in_a_csv(tmp_path: Path) -> None:
    t = np.linspace(0.0, 1.0, 200)
    path = tmp_path / "step.csv"
    path.write_text("time,speed\n" + "".join(f"{a:.6f},{3 * (1 - np.exp(-a / 0.1)):.9f}\n" for a in t))
    found = json.loads(run(identify.command, str(path), "--step", "2", "--json"))
    assert found["parameters"] == pytest.approx({"gain": 1.5, "lag": 0.1}, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "model", "what"),
    [
        ("0,0\n0.1,nan\n", "first-order", r"gap\.csv:2: column 2 holds 'nan'"),
        ("0,0\n0.1\n", "first-order", r"gap\.csv:2: expected 2 columns, not 1"),
        ("time,y\n", "first-order", "holds no rows"),
        ("".join(f"{i * 1e-3 + (i > 150) * 0.05},{i},{i}\n" for i in range(300)), "inverse-dynamics",
         "has a gap behind row 151"),
    ],
)  # fmt: skip
def test_recordings_with_gaps_are_named(tmp_path: Path, text: str, model: str, what: str) -> None:
    path = tmp_path / "gap.csv"
    path.write_text(text)
    result = CliRunner().invoke(identify.command, [str(path), "--model", model])
    assert isinstance(result.exception, RecordingError)
    with pytest.raises(RecordingError, match=what):
        raise result.exception


def test_a_joint_is_identified_on_its_twin(tmp_path: Path) -> None:
    page = tmp_path / "response.html"
    found = json.loads(run(identify.command, "-m", "xy-table", "--joint", "X", "--json", "-o", str(page)))
    assert found["model"] == "one-mass"
    assert found["parameters"]["motor_inertia"] == pytest.approx(7.1626e-5, rel=0.01)
    assert found["parameters"]["viscous"] == pytest.approx(2e-4, rel=0.01)
    assert set(found["uncertainty"]) <= set(found["parameters"])
    text = page.read_text()
    assert "<svg" in text
    assert "coulomb" in text


def test_a_joint_is_tuned_on_its_twin(tmp_path: Path) -> None:
    picture = tmp_path / "tuned.png"
    found = json.loads(run(tune.command, "-m", "xy-table", "--joint", "X", "--json", "-o", str(picture)))
    assert set(found) >= {"model", "uncertainty", "gains", "margins", "metrics"}
    assert found["margins"]["ms"] <= 1.6
    assert found["margins"]["gm"] > 2.0
    assert found["metrics"]["settling_s"] < 0.1
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_simc_on_the_command_line() -> None:
    found = json.loads(run(tune.command, "--gain", "2", "--lag", "3", "--dead", "1", "--json"))
    assert found["margins"] == pytest.approx({"gm": 3.142, "pm_deg": 61.35, "ms": 1.590}, abs=0.01)
    assert found["gains"]["kp"] == pytest.approx(0.75)


def test_bandwidth_and_damping_on_the_command_line() -> None:
    words = ("--gain", "2.0866", "--lag", "0.01346", "--bandwidth", "20", "--json")
    assert json.loads(run(tune.command, *words))["margins"]["pm_deg"] > 45.0


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("-m", "router"), "no servo joint"),
        (("-m", "xy-table", "--joint", "Z"), "There are: X, Y"),
        (("--gain", "2", "--lag", "0", "--dead", "1"), "lag: must be above zero"),
        (("--gain", "2", "--lag", "1", "--bandwidth", "0.01"), "quicker than the loop"),
    ],
)
def test_what_cannot_be_tuned_is_named(words: tuple[str, ...], what: str) -> None:
    result = CliRunner().invoke(tune.command, words)
    assert isinstance(result.exception, ConfigError)
    assert what in str(result.exception)


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("--gain", "2"), "needs --dead"),
        (("-m", "xy-table", "--rule", "simc"), "is for a model's numbers"),
        (("--rule", "shaping"), "give a machine with -m"),
    ],
)
def test_options_that_do_not_go_together_are_named(words: tuple[str, ...], what: str) -> None:
    result = CliRunner().invoke(tune.command, words)
    assert result.exit_code == 2
    assert what in result.output
