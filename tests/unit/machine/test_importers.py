"""Other controllers' settings: every number mapped exactly, every line accounted for."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import pytest

from trochia.errors import ConfigError
from trochia.machine.dump import dumps
from trochia.machine.importers import IMPORTERS, Imported, detect, ini
from trochia.machine.load import loads
from trochia.machine.read import read

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.machine.machine import Machine

FILES = {
    "grbl.txt": "grbl", "grbl09.txt": "grbl", "mill_inch.ini": "linuxcnc", "lathe_old.ini": "linuxcnc",
    "cartesian.cfg": "klipper", "corexy.cfg": "klipper",
}  # fmt: skip


def imported(text: str, kind: str) -> tuple[Machine, Imported]:
    result = IMPORTERS[kind].read(text, "settings")
    document: dict[str, Any] = {"format": 1, "name": "imported"} | result.document
    machine, problems = read(document, "settings")
    assert problems == []
    assert machine is not None
    return machine, result


def from_file(settings: Path, name: str) -> tuple[Machine, Imported]:
    return imported((settings / name).read_text(), FILES[name])


@pytest.mark.parametrize("name", FILES)
def test_is_recognised_and_makes_a_machine_that_loads(settings: Path, name: str):
    assert detect((settings / name).read_text(), name).kind == FILES[name]
    machine, _ = from_file(settings, name)
    assert loads(dumps(machine, comments=True)) == machine


@pytest.mark.parametrize("name", FILES)
def test_every_line_is_mapped_or_reported(settings: Path, name: str):
    """Taking any one line away changes the machine, the assumptions, or the report; nothing is silent."""
    text = (settings / name).read_text()
    _, whole = from_file(settings, name)
    reported = {each.setting.line for each in whole.unmapped}
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        said = line.split("#")[0].strip() if not line.startswith("#*#") else line
        if not said or said.startswith(("[", "Grbl", "$$", "ok", "TYPE", "AXES", "COORDINATES", "JOINTS", "ANGULAR")):
            continue
        if number in reported or line[0] in " \t":
            continue
        without = "\n".join(lines[: number - 1] + lines[number:])
        try:
            result = IMPORTERS[FILES[name]].read(without, name)
        except ConfigError:
            continue
        assert _account(result) != _account(whole), line


def _account(result: Imported) -> tuple[object, ...]:
    return result.document, result.assumed, [(each.setting.full_name, each.why) for each in result.unmapped]


def test_grbl(settings: Path):
    machine, result = from_file(settings, "grbl.txt")
    x, y, z = machine.axes
    assert (x.minimum, x.maximum, x.velocity, x.acceleration) == (-300.0, 0.0, 50.0, 150.0)
    assert [joint.steps_per_unit for joint in machine.joints] == [
        -250,
        Fraction("26.67"),
        -800,
    ]  # $3=5: X and Z inverted
    assert machine.dialect == "grbl"
    assert z.velocity == pytest.approx(500 / 60)
    assert y.minimum == -180.0
    assert {joint.pulses.length for joint in machine.joints} == {10e-6}
    assert machine.spindle is not None
    assert (machine.spindle.maximum, machine.spindle.minimum) == (12000.0, 600.0)
    assert Counter(each.setting.name for each in result.unmapped) == Counter(
        [
            "$1",
            "$2",
            "$4",
            "$5",
            "$6",
            "$10",
            "$11",
            "$12",
            "$13",
            "$20",
            "$21",
            "$22",
            "$23",
            "$24",
            "$25",
            "$26",
            "$27",
        ]
    )


def test_grbl_laser_without_z(settings: Path):
    machine, result = from_file(settings, "grbl09.txt")
    assert [axis.name for axis in machine.axes] == ["X", "Y"]
    assert machine.spindle is None
    assert machine.beam is not None
    assert (machine.beam.kind, machine.beam.full_power) == ("power", 255.0)
    assert [each.setting.name for each in result.unmapped] == ["$102", "$112", "$122", "$132", "garbage from the line"]


def test_linuxcnc_in_inches_with_a_gantry(settings: Path):
    machine, result = from_file(settings, "mill_inch.ini")
    assert [axis.name for axis in machine.axes] == ["X", "Y", "Z", "A"]
    x, _, z, a = machine.axes
    assert (x.minimum, x.maximum, x.velocity, x.acceleration) == (-12.7, 609.6, 63.5, 508.0)
    assert (a.maximum, a.velocity) == (9999.0, 60.0)
    assert z.maximum == 0.0254
    assert [joint.steps_per_unit for joint in machine.joints] == [
        8000 / Fraction("25.4"), 8000 / Fraction("25.4"), -8000 / Fraction("25.4"), None, 160,
    ]  # fmt: skip
    assert machine.joints[3].counts_per_unit == -20000 / Fraction("25.4")
    assert machine.kinematics.matrix.tolist() == [
        [1, 0, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1],
    ]  # fmt: skip
    one = machine.joints[0]
    assert one.backlash == 0.0508
    assert (one.pulses.length, one.pulses.space, one.pulses.setup, one.pulses.hold) == (5e-6, 4e-6, 10e-6, 12e-6)
    assert machine.path.velocity == 76.2
    assert machine.servo_period == 0.001
    names = [each.setting.full_name for each in result.unmapped]
    assert names.count("[HAL]HALFILE") == 2
    assert {"#INCLUDE spindle.inc", "[JOINT_0]HOME_SEARCH_VEL", "[JOINT_3]P"} <= set(names)


def test_an_older_linuxcnc_lathe(settings: Path):
    machine, _ = from_file(settings, "lathe_old.ini")
    assert machine.kinematics.kind == "lathe"
    assert [joint.steps_per_unit for joint in machine.joints] == [400, 300]
    assert [axis.name for axis in machine.axes] == ["X", "Z"]
    assert machine.joints[0].backlash == 0.05


def test_klipper_cartesian(settings: Path):
    machine, result = from_file(settings, "cartesian.cfg")
    assert [joint.steps_per_unit for joint in machine.joints] == [
        -3200 / Fraction(40),
        12800 * Fraction(15, 2) / 40,
        3200 / Fraction(8),
        -3200 / Fraction(8),
    ]
    assert [(axis.minimum, axis.maximum) for axis in machine.axes] == [(0.0, 220.0), (-5.0, 230.0), (-2.0, 250.0)]
    assert [axis.velocity for axis in machine.axes] == [300.0, 300.0, 5.0]
    assert (machine.path.velocity, machine.path.acceleration) == (300.0, 3000.0)
    assert machine.joints[3].pulses.length == 4e-6
    names = [each.setting.full_name for each in result.unmapped]
    assert {"[extruder]control", "[gcode_macro HELLO]gcode", "[include macros.cfg]", "[exclude_object]"} <= set(names)
    assert "#*# position_endstop = 1.2" in names


def test_klipper_corexy_with_two_z_motors(settings: Path):
    machine, _ = from_file(settings, "corexy.cfg")
    assert machine.kinematics.matrix.tolist() == [[1, 1, 0], [1, -1, 0], [0, 0, 1], [0, 0, 1]]
    assert [joint.steps_per_unit for joint in machine.joints] == [80, 80, 400, 400]


@pytest.mark.parametrize(
    ("kind", "text", "says"),
    [
        ("grbl", "$100=250\n", r"found no whole axis"),
        ("grbl", "$100=fast\n$110=1\n$120=1\n$130=1\n", r"settings:1: \$100: expected a number, not 'fast'"),
        ("linuxcnc", "[KINS]\nKINEMATICS = genhexkins\n", r"settings:2: .*'genhexkins'"),
        ("linuxcnc", "[TRAJ]\nLINEAR_UNITS = furlong\n", r"settings:2: .*mm or inch"),
        ("linuxcnc", "[TRAJ]\nANGULAR_UNITS = radian\n", r"expected degree"),
        ("linuxcnc", "[TRAJ]\nCOORDINATES = X Q\n", r"axis letters"),
        ("linuxcnc", "[KINS]\nJOINTS = 3\n", r"axis X: no MIN_LIMIT"),
        ("klipper", "[printer]\nkinematics: delta\n", r"settings:2: .*'delta'"),
        ("klipper", "[stepper_x]\nposition_max: 5\n", r"kinematics in the section \[printer\]"),
        ("klipper", "[printer]\nkinematics: cartesian\nmax_velocity: 5\n", r"settings:2: expected max_accel"),
        ("klipper", "[printer]\nkinematics: cartesian\nmax_velocity: 5\nmax_accel: 9\n", r"\[stepper_x\]"),
        (
            "klipper",
            "[printer]\nkinematics: cartesian\nmax_velocity: 5\nmax_accel: 9\n[stepper_x]\nposition_max: 9\n",
            r"settings:6: expected rotation_distance",
        ),
    ],
)
def test_what_cannot_be_imported_says_so(kind: str, text: str, says: str):
    with pytest.raises(ConfigError, match=says):
        IMPORTERS[kind].read(text, "settings")


def test_a_file_of_no_known_kind():
    with pytest.raises(ConfigError, match=r"--from grbl\|klipper\|linuxcnc"):
        detect("G0 X10\n", "part.ngc")


def test_a_setting_given_twice_is_reported():
    text = "$100=100\n$110=600\n$120=50\n$130=200\n$100=200\n"
    machine, result = imported(text, "grbl")
    assert machine.joints[0].steps_per_unit == 200
    assert [(each.setting.line, each.why) for each in result.unmapped] == [(1, "line 5 gives it again")]


def test_lines_of_ini_files():
    text = "[a]\nx = 1 ; no comment here\n  more\n[empty]\n; gone\ny\\\n = 2\n"
    assert [
        (s.section, s.name, s.value, s.line) for s in ini.settings(text, separators="=", continued="backslash")
    ] == [
        ("a", "x", "1 ; no comment here", 2),
        ("a", "more", "", 3),
        ("empty", "y", "2", 6),
    ]
    assert [s.value for s in ini.settings("[a]\nx: 1 # gone\n  more\n", separators=":=", inline_comments="#;",
                                          continued="indent")] == ["1\nmore"]  # fmt: skip
