"""``trochia machine``: what a new user sees, what a script gets, what a mistake says."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from trochia.cli.machine import command
from trochia.errors import ConfigError, MachineError
from trochia.machine.load import load, shipped

SETTINGS = Path(__file__).parents[1] / "machine" / "settings"


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)

    def call(*words: str, answers: list[str] | None = None, fails: bool = False) -> Result:
        result = CliRunner().invoke(command, list(words), input="\n".join(answers or []) + "\n")
        if not fails and result.exception:
            raise result.exception
        return result

    return call


def test_show_lists_what_comes_with_trochia(run):
    result = run("show")
    for name in shipped():
        assert name in result.stdout
    assert {row["name"] for row in json.loads(run("show", "--json").stdout)["machines"]} == set(shipped())


def test_show_tells_a_person_what_matters(run):
    shown = run("show", "reference-mill").stdout
    for words in (
        "200 mm/s",
        "800 mm/s²",
        "20000 mm/s³",
        "200 /mm",
        "5 µm",
        "40,000 steps/s",
        "29 mm",
        "-500 .. 500 mm",
    ):
        assert words in shown


@pytest.mark.parametrize("name", shipped())
def test_show_has_a_row_for_every_axis_and_joint(run, name: str):
    machine = load(name)
    shown = run("show", name).stdout
    data = json.loads(run("show", name, "--json").stdout)
    assert [axis["name"] for axis in data["axes"]] == [axis.name for axis in machine.axes]
    assert [joint["name"] for joint in data["joints"]] == [joint.name for joint in machine.joints]
    for line in shown.splitlines():
        assert line == line.rstrip()
    for joint in machine.joints:
        assert any(line.startswith(f"{joint.name} ") for line in shown.splitlines())


def test_show_as_data_has_units_in_its_keys_and_exact_scales(run):
    data = json.loads(run("show", "lathe", "--json").stdout)
    z = data["joints"][1]
    assert z["counts_per_mm"] == "31200/127"
    assert data["axes"][1]["velocity_mm_s"] == 5.8
    a = json.loads(run("show", "rotary-mill", "--json").stdout)["axes"][3]
    assert a["velocity_deg_s"] == 60.0


def test_check_says_yes(run):
    result = run("check", "laser", "lathe")
    assert result.exit_code == 0
    assert result.stdout.splitlines()[0].startswith("laser: ok")


def test_check_gives_every_mistake(run):
    run("new", "mill.toml", "--defaults")
    text = Path("mill.toml").read_text()
    Path("mill.toml").write_text(text.replace('"100 mm/s"', '"100"').replace("microsteps = 8", "microsteps = 0"))
    result = run("check", "mill.toml", fails=True)
    assert result.exit_code == 2
    assert "mill.toml: 5 mistakes" in result.stderr
    data = json.loads(run("check", "--json", "mill.toml", fails=True).stdout)
    assert data["ok"] is False
    first = data["problems"][0]
    assert (first["severity"], first["code"], first["key"]) == ("error", "unit", "axes.X.velocity")
    assert text.splitlines()[first["line"] - 1].startswith("velocity")


def test_check_of_a_missing_file(run):
    result = run("check", "nowhere.toml", fails=True)
    assert result.exit_code == 2
    assert "nowhere.toml" in result.stderr
    assert json.loads(run("check", "--json", "nowhere.toml", fails=True).stdout)["problems"][0]["line"] is None


def test_new_without_questions(run):
    run("new", "--defaults", "--axes", "XYA", "--travel", "X=-10..500 mm", "--velocity", "6 m/min",
        "--set", "joints.X.motor.microsteps=16", "--set", "description=My mill", "mine.toml")  # fmt: skip
    machine = load("mine.toml")
    x, y, a = machine.axes
    assert (machine.name, machine.description) == ("mine", "My mill")
    assert (x.minimum, x.maximum, x.velocity, y.velocity) == (-10.0, 500.0, 100.0, 100.0)
    assert a.rotary
    assert machine.joints[0].steps_per_unit == 640


@pytest.mark.parametrize("kinematics", ["cartesian", "corexy", "lathe"])
def test_new_of_every_kinematics_loads(run, kinematics: str):
    run("new", "--defaults", "--kinematics", kinematics, "m.toml")
    assert load("m.toml").kinematics.kind == kinematics


def test_the_new_file_explains_its_keys(run):
    run("new", "--defaults", "m.toml")
    text = Path("m.toml").read_text()
    for words in ("# greatest velocity", "# jerk =", "# backlash =", "# path_tolerance ="):
        assert words in text


def test_the_wizard_asks_again_at_once(run):
    answers = [
        "cartesian", "XQ", "X",  # axes
        "0 mm", "-5 mm", "300", "300 mm", "90 m/s", "", "",  # axis X: below minimum, without unit, right, far too fast
        "stepper", "0", "200", "8", "belt", "2 mm", "20.5", "20", "", "",  # motor: no steps; pulley with half a tooth
        "", "",  # no spindle, no beam
        "axes.X.velocity", "300 mm/s",  # too many steps a second: change what the message names
    ]  # fmt: skip
    result = run("new", "m.toml", answers=answers)
    machine = load("m.toml")
    assert (machine.axes[0].maximum, machine.axes[0].velocity) == (300.0, 300.0)
    assert machine.joints[0].steps_per_unit == 40
    for words in ("not 'Q'", "expected more than 0 mm", "with its unit", "above zero", "whole number", "do not fit"):
        assert words in result.stderr


def test_a_servo_with_spindle_and_beam(run):
    first = ["servo", "leadscrew", "5 mm", "", "10000", ""]
    second = ["servo", "travel", "40 mm", "", "", "0.1 mm"]
    tool = ["24000 rpm", "3 s", "power", "255"]
    answers = ["corexy", "XY", *[""] * 10, *first, *second, *tool]
    run("new", "m.toml", answers=answers)
    machine = load("m.toml")
    assert machine.spindle is not None
    assert machine.spindle.spin_up == 3.0
    assert machine.beam is not None
    assert machine.beam.full_power == 255.0
    assert [joint.counts_per_unit for joint in machine.joints] == [2000, Fraction("102.4")]


def test_stopping_the_wizard_writes_nothing(run, tmp_path: Path):
    result = run("new", "m.toml", answers=["cartesian", "X"], fails=True)
    assert result.exit_code != 0
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_written_over_without_force(run):
    Path("m.toml").write_text("mine")
    for words in (("new", "--defaults", "m.toml"), ("import", str(SETTINGS / "grbl.txt"), "-o", "m.toml")):
        result = run(*words, fails=True)
        assert isinstance(result.exception, ConfigError)
        assert "--force" in str(result.exception)
    assert Path("m.toml").read_text() == "mine"
    run("new", "--defaults", "--force", "m.toml")
    assert load("m.toml").name == "m"


def test_a_file_that_cannot_be_written_leaves_nothing_behind(run, tmp_path: Path):
    result = run("new", "--defaults", "no/such/folder/m.toml", fails=True)
    assert isinstance(result.exception, ConfigError)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "wrong", ["axes.X.velocity=10 A", "axes.X.speed=1", "name=", "format=3", "axes.X.velocity.top=3"]
)
def test_a_wrong_set_is_refused_and_nothing_written(run, tmp_path: Path, wrong: str):
    result = run("new", "--defaults", "--set", wrong, "m.toml", fails=True)
    assert isinstance(result.exception, MachineError)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [("--set", "velocity"), ("--travel", "X"), ("--travel", "W=0..5 mm")])
def test_a_badly_formed_option_is_a_usage_error(run, words: tuple[str, str]):
    assert run("new", "--defaults", *words, "m.toml", fails=True).exit_code == 2


def test_import_writes_a_machine_and_reports_the_rest(run):
    result = run("import", str(SETTINGS / "grbl.txt"), "-o", "m.toml")
    machine = load("m.toml")
    assert machine.joints[0].steps_per_unit == -250
    assert "$27 = 1.000" in result.stderr
    assert "assumed: travel" in result.stderr
    assert "# - travel from minus the maximum to 0" in Path("m.toml").read_text()


def test_import_prints_without_output(run):
    result = run("import", str(SETTINGS / "corexy.cfg"), "--name", "voron")
    Path("m.toml").write_text(result.stdout)
    assert load("m.toml").name == "voron"


def test_import_as_data(run):
    data = json.loads(run("import", "--json", str(SETTINGS / "mill_inch.ini")).stdout)
    assert data["from"] == "linuxcnc"
    assert {"key": "[HAL]HALFILE", "value": "one.hal", "line": 20, "why": "no place in a machine file"} in data[
        "unmapped"
    ]
    assert data["toml"].startswith("# Imported")


def test_import_names_what_to_change_when_settings_make_no_machine(run):
    text = (SETTINGS / "corexy.cfg").read_text().replace("microsteps: 16", "microsteps: 256")
    Path("fine.cfg").write_text(text)
    result = run("import", "fine.cfg", fails=True)
    assert isinstance(result.exception, ConfigError)
    assert "--set joints.belt-b.velocity=VALUE" in str(result.exception)
    changes = [word for joint in ("belt-b", "Z", "Z1") for word in ("--set", f"joints.{joint}.velocity=20 mm/s")]
    assert run("import", "fine.cfg", *changes).exit_code == 0


@pytest.mark.parametrize("data", [b"\0\1\2", b"G0 X1\n", b""])
def test_import_of_something_else(run, data: bytes):
    Path("thing").write_bytes(data)
    assert isinstance(run("import", "thing", fails=True).exception, ConfigError)
