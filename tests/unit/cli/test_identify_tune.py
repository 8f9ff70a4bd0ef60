"""The commands ``identify`` and ``tune``: what they say, and what they refuse."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from click.testing import CliRunner

from trochia import api
from trochia.analysis.identification.two_mass import plant_of
from trochia.cli import identify, tune
from trochia.errors import ConfigError, LimitError, MachineError, RecordingError
from trochia.experiments import TwinAxis
from trochia.experiments.signals import chirp
from trochia.kernels.servo import ServoKernel
from trochia.machine.servos import CascadeLoop
from trochia.servo.axis import plant_members

if TYPE_CHECKING:
    from trochia.kernels.servo import ServoSamples

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


@pytest.mark.parametrize(("rule", "kp"), [("ziegler-nichols-closed", 6.0), ("tyreus-luyben", 3.125)])
def test_rules_from_an_ultimate_gain_on_the_command_line(rule: str, kp: float) -> None:
    assert json.loads(run(tune.command, "--rule", rule, "--ku", "10", "--tu", "0.2", "--json"))["gains"]["kp"] == kp


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


def shaken(path: Path) -> None:
    """Write the motion of two masses under a chirp: time, torque, position."""
    plant = plant_of([1e-4, 2e-4, 12.0, 2e-3, 0.5], 1e-3, 3e-4)
    torque = np.tile(chirp(1024, 1e-3, (2.0, 200.0)), 8)
    rows = ServoKernel(plant_members(plant, 1e-5)).drive(torque, steps=100).measured
    rows = rows + np.random.default_rng(1).normal(0.0, 2e-5, len(rows))
    np.savetxt(path, np.stack([1e-3 * np.arange(len(torque)), torque, rows], axis=1), delimiter=",",
               header="time,torque,position", comments="")  # fmt: skip


def test_a_chirp_in_a_csv_gives_response_coherence_and_two_masses(tmp_path: Path) -> None:
    path, page = tmp_path / "chirp.csv", tmp_path / "response.html"
    shaken(path)
    seen = json.loads(run(identify.command, str(path), "--model", "frequency-response", "--json"))
    assert seen["coherence_median"] > 0.99
    assert set(seen["response"][0]) == {"frequency_Hz", "magnitude", "phase_deg", "coherence"}
    words = (str(path), "--model", "two-mass", "--viscous", "1e-3", "-o", str(page))
    found = json.loads(run(identify.command, *words, "--json"))
    expected = {"motor_inertia": 1e-4, "load_inertia": 2e-4, "stiffness": 12.0, "lag": 3e-4}
    assert {name: found["parameters"][name] for name in expected} == pytest.approx(expected, rel=0.01)
    assert found["parameters"]["damping"] == pytest.approx(2e-3, rel=0.05)
    assert found["uncertainty"]["viscous"] is None  # taken as known
    assert found["files"] == [str(page)]
    assert "<svg" in page.read_text()


ROW = """voltage = "48 V"
resistance = "2.45 ohm"
inductance = "0.513 mH"
torque_constant = "53.8 mN·m/A"
inertia = "34.7 g·cm²"
no_load_current = "78.6 mA"
no_load_speed = "8490 rpm"
stall_torque = "1050 mN·m"
time_constant = "2.94 ms"
source = "maxon's sheet of its 30 mm motor of 48 V"
"""


def test_a_catalogue_s_row_gives_constants_and_is_held_to_itself(tmp_path: Path) -> None:
    path = tmp_path / "motor.toml"
    path.write_text(ROW)
    found = json.loads(run(identify.command, str(path), "--json"))
    assert all(abs(off) < 0.01 for off in found["deviations"].values())
    assert found["parameters"]["no_load_speed"] == pytest.approx(8490, rel=0.01)
    for name, value in (("no_load_speed", 8490), ("stall_torque", 1.05), ("mechanical_time", 2.94e-3)):
        assert abs(found["parameters"][name] - value) < 3.0 * found["uncertainty"][name]
    assert "stall torque of the row: +0.38% off" in run(identify.command, str(path))
    path.write_text(ROW.replace('"78.6 mA"', '"25 A"'))
    with pytest.raises(ConfigError, match="take more than the 48 V"):
        run(identify.command, str(path))
    amperes = ROW.replace("48 V", "48 A")
    for text, what in ((amperes, "expected a voltage"), (ROW + "kt = 1\n", "kt"), ("= 3", "not TOML"), ("", "voltage")):
        path.write_text(text)
        with pytest.raises(MachineError, match=what):
            run(identify.command, str(path))


@pytest.mark.parametrize(
    ("rows", "what"),
    [
        ("0,0,0\n" * 200, "times do not rise"),
        ("".join(f"{i * 1e-3},0,{i}\n" for i in range(20)), "too few for windows"),
        ("".join(f"{i * 1e-3 + (i > 500)},1,{i}\n" for i in range(1000)), "has a gap behind row 501"),
    ],
)
def test_data_that_give_no_response_are_named(tmp_path: Path, rows: str, what: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(rows)
    with pytest.raises(RecordingError, match=what):
        run(identify.command, str(path), "--model", "frequency-response")


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """Return a machine file of one's own."""
    path = tmp_path / "table.toml"
    path.write_text((resources.files("trochia") / "data" / "machines" / "xy-table.toml").read_text(encoding="utf-8"))
    return path


def test_found_by_experiment_tuned_applied_run_and_undone(table: Path, tmp_path: Path) -> None:
    """From an axis nobody knows to a tuned one in its file, which simulate then runs, and back."""
    before, page = table.read_text(), tmp_path / "tuned.html"
    found = json.loads(run(tune.command, "-m", str(table), "-j", "X", "--identify", "--apply", "--json", "-o",
                           str(page)))  # fmt: skip
    assert found["model"]["motor_inertia"] == pytest.approx(7.1626e-5, rel=0.01)
    assert found["model"]["lag_s"] == pytest.approx(3e-4, rel=0.1)
    assert found["uncertainty"]["motor_inertia"] > 0.0
    assert found["before"]["margins"]["ms"] < found["margins"]["ms"] <= 1.6
    assert found["metrics"]["following_error_peak"] < 0.1 * found["before"]["following_error_peak"]
    assert found["files"] == [str(page), str(table)]
    text = page.read_text()
    assert text.count("<svg") == 1
    assert "→" in text
    tuned = api.load(table).joints[0].loop
    assert isinstance(tuned, CascadeLoop)
    assert tuned.position_gain == found["gains"]["position_gain"]
    moved = json.loads(run(tune.command, "-m", str(table), "--move", "parabolic", "--size", "10 mm", "--json"))
    assert moved["margins"] == pytest.approx(found["margins"], rel=1e-6)
    assert moved["metrics"]["following_error_peak"] < 0.003
    assert json.loads(run(tune.command, "-m", str(table), "--undo", "--json"))["undone"] == "joints.X.loop"
    assert table.read_text() == before
    with pytest.raises(ConfigError, match="nothing to undo"):
        run(tune.command, "-m", str(table), "--undo")


def test_a_shipped_machine_is_not_written_to() -> None:
    with pytest.raises(ConfigError, match=r"is not written to(.|\n)*Copy it first: cp "):
        run(tune.command, "-m", "xy-table", "--apply")
    with pytest.raises(ConfigError, match="is no file"):
        run(tune.command, "-m", "xy-table", "--undo")


@pytest.mark.parametrize("kind", ["step", "parabolic"])
def test_a_move_tells_its_figures_and_draws_them(kind: str, tmp_path: Path) -> None:
    page = tmp_path / "move.html"
    words = ("-m", "xy-table", "-j", "Y", "--move", kind, "--size", "1 mm", "-o", str(page))
    found = json.loads(run(tune.command, *words, "--json"))
    names = {"rise_s", "settling_s", "overshoot"} if kind == "step" else {"following_error_peak", "with_speed_s"}
    assert names <= set(found["metrics"])
    assert found["move"]["size"] == 1.0
    assert set(found["suggested"]) == (set() if kind == "step" else {"i32", "i35"})
    said = run(tune.command, *words)
    assert ("settled within" if kind == "step" else "suggested i32") in said
    assert "<svg" in page.read_text()


def test_the_leadscrew_s_chip_is_tried_as_it_computes() -> None:
    """Its gains, in volts: the crossover and margin that were published for them, but for sampling and the winding."""
    found = json.loads(run(tune.command, "-m", "lathe", "-j", "Z", "--move", "parabolic", "--json"))
    assert found["margins"]["pm_deg"] == pytest.approx(71.5, abs=1.0)
    assert found["metrics"]["following_error_peak"] < 0.05


def test_a_relay_tunes_a_joint() -> None:
    found = json.loads(run(tune.command, "-m", "xy-table", "--rule", "relay", "--json"))
    gains = found["gains"]
    assert gains["kind"] == "pid"
    assert gains["kp"] == pytest.approx(0.6 * gains["ku"], rel=1e-4)
    assert gains["ku_sigma"] < 0.2 * gains["ku"]


class CutError(RuntimeError):
    """A line that breaks."""


@pytest.mark.parametrize("words", [("--identify",), ("--rule", "relay")])
@pytest.mark.parametrize("failure", [CutError, KeyboardInterrupt, LimitError("stopped: travel was exceeded")])
@pytest.mark.parametrize("after", [3, 40])
def test_tuning_never_leaves_a_motor_enabled(
    words: tuple[str, ...], failure: BaseException | type[BaseException], after: int, table: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Whatever breaks in the middle, the last thing that every axis was told is off, and the file is as it was."""
    axes: list[TwinAxis] = []
    real, advance, calls = TwinAxis.__init__, TwinAxis.advance, [0]

    def made(self: TwinAxis, *given: object, **more: object) -> None:
        axes.append(self)
        real(self, *given, **more)  # type: ignore[arg-type]

    def breaks(self: TwinAxis, *given: object) -> ServoSamples:
        calls[0] += 1
        if calls[0] > after:
            assert self.enabled, "it breaks while the motor is on"
            raise failure
        return advance(self, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(TwinAxis, "__init__", made)
    monkeypatch.setattr(TwinAxis, "advance", breaks)
    before = table.read_text()
    result = CliRunner().invoke(tune.command, ["-m", str(table), "--apply", *words])
    assert result.exit_code != 0
    assert axes
    assert not any(axis.enabled for axis in axes)
    assert table.read_text() == before


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("--undo",), "give a machine with -m"),
        (("-m", "xy-table", "--undo", "--apply"), "and nothing else"),
        (("-m", "xy-table", "--size", "1 mm"), "are of a --move"),
        (("-m", "xy-table", "--move", "step", "--apply"), "tunes nothing"),
        (("-m", "xy-table", "--move", "step", "--size", "3 V"), "expected a length"),
        (("-m", "xy-table", "--move", "step", "--size", "0 mm"), "must not be zero"),
        (("-m", "xy-table", "--move", "parabolic", "--time", "0 s"), "above zero"),
        (("-m", "xy-table", "-o", "tuned.bmp"), "ends in .png"),
    ],
)
def test_options_of_moves_and_files_are_held_together(words: tuple[str, ...], what: str) -> None:
    result = CliRunner().invoke(tune.command, words)
    assert result.exit_code == 2
    assert what in result.output


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (("--size", "1000 mm"), "travel is -150 to 150"),
        (("--size", "20 mm", "--time", "0.1 s"), "would run at 300 a second; 42 is allowed"),
    ],
)
def test_moves_that_would_exceed_are_refused_before_moving(words: tuple[str, ...], what: str) -> None:
    with pytest.raises(LimitError, match=what) as raised:
        run(tune.command, "-m", "xy-table", "--move", "parabolic", *words)
    assert "Nothing has moved" in str(raised.value)
