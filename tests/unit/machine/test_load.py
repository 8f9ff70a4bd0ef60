"""Machine files: what is right becomes exact values, what is wrong one clear error in its place."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import TYPE_CHECKING

import pytest

from trochia.errors import ConfigError, MachineError, UnitError
from trochia.machine.axes import AxisKind
from trochia.machine.load import inspect, inspect_text, load, loads, shipped

if TYPE_CHECKING:
    from pathlib import Path


def test_reads_units_and_exact_gearing(good: str):
    machine = loads(good)
    x, a = machine.axes
    assert (x.kind, x.maximum, x.velocity) == (AxisKind.LINEAR, 100.0, 50.0)
    assert (a.kind, a.minimum, a.velocity) == (AxisKind.ROTARY, -360.0, 360.0)
    assert machine.joints[0].steps_per_unit == 800 / Fraction("5.08")
    assert machine.joints[1].steps_per_unit == 200 * Fraction(5, 2) / 360
    assert machine.columns == (0, 3)


def test_axes_stand_in_the_letters_order_whatever_the_files(good: str):
    head, x, a, rest = _parts(good)
    assert loads(head + a + x + rest) == loads(good)


def _parts(text: str) -> tuple[str, str, str, str]:
    x, a, joints = text.index("[axes.X]"), text.index("[axes.A]"), text.index("[joints.X]")
    return text[:x], text[x:a], text[a:joints], text[joints:]


#: what is changed, into what; line, key, and what the message must say
MISTAKES = [
    ("format = 1\n", "", 1, "format", ["missing", "format = 1"]),
    ("format = 1", "format = 2", 1, "format", ["expected 1", "not 2"]),
    ('name = "small"\n', "", 1, "name", ["missing"]),
    ('name = "small"', "name = 5", 2, "name", ["text in quotes", "not 5"]),
    ('name = "small"', 'name = ""', 2, "name", ["must not be empty"]),
    ('"cartesian"', '"cartesean"', 3, "kinematics", ["'cartesean'", "did you mean cartesian?"]),
    ('kinematics = "cartesian"\n', "", 1, "kinematics", ["missing", "cartesian, corexy, lathe"]),
    ('kinematics = "cartesian"', 'kinematics = "cartesian"\nspeed = 1', 4, "speed", ["unknown key"]),
    ('"50 mm/s"', '"50"', 8, "axes.X.velocity", ["expected a velocity with its unit", "'50'"]),
    ('"50 mm/s"', "50", 8, "axes.X.velocity", ["expected a velocity with its unit", "not 50"]),
    ('"50 mm/s"', '"50 A"', 8, "axes.X.velocity", ["'50 A'", "unit of current"]),
    ('"50 mm/s"', '"0 mm/s"', 8, "axes.X.velocity", ["above zero", "0 mm/s"]),
    ("velocity =", "velocty =", 8, "axes.X.velocty", ["unknown key", "did you mean velocity?"]),
    ('velocity = "50 mm/s"\n', "", 5, "axes.X.velocity", ["missing", "10 mm/s"]),
    ('"1 rev/s"', '"1 m/s"', 14, "axes.A.velocity", ["expected an angular velocity", "'1 m/s'"]),
    ('"100 mm"', '"-1 mm"', 7, "axes.X.maximum", ["above minimum", "-1 mm"]),
    ("[axes.A]", "[axes.Q]", 11, "axes.Q", ["one of the letters", "X Y Z A B C U V W"]),
    ("[axes.A]", '[axes.A]\nkind = "linar"', 12, "axes.A.kind", ["linear, rotary", "'linar'", "did you mean linear?"]),
    ("[axes.A]", "[axis.A]", 11, "axis", ["unknown key", "did you mean axes?"]),
    ("full_steps = 200", 'full_steps = "200"', 18, "joints.X.motor.full_steps", ["whole number", "'200'"]),
    ("full_steps = 200", "full_steps = 0", 18, "joints.X.motor.full_steps", ["above zero", "not 0"]),
    ('kind = "stepper", full', 'kind = "steper", full', 18, "joints.X.motor.kind", ["did you mean stepper?"]),
    ('kind = "stepper", full', "full", 18, "joints.X.motor.kind", ["stepper, servo", "missing"]),
    ('{ kind = "leadscrew", lead = "0.2 in" }', '"screw"', 19, "joints.X.transmission", ["a table", "'screw'"]),
    ('lead = "0.2 in"', 'lead = "0.2 s"', 19, "joints.X.transmission.lead", ["expected a length", "unit of time"]),
    ('lead = "0.2 in"', 'pitch = "2 mm"', 19, "joints.X.transmission.lead", ["missing", "2 mm"]),
    ('lead = "0.2 in"', 'lead = "2 mm", ratio = 0', 19, "joints.X.transmission.ratio", ["not zero", "not 0"]),
    ('"5/2"', '"5/0"', 24, "joints.A.transmission.ratio", ["bare number", "'5/0'"]),
    ('"direct", ratio = "5/2"', '"belt", pitch = "2 mm", teeth = 20', 24, "joints.A.transmission.kind", ["in mm"]),
    ('length = "5 us"', 'length = "200 us"', 17, "joints.X.velocity", ["7874.02 steps/s", "4878.05", "30.9756"]),
    ("[joints.A]", "[joints.B]", 22, "joints.B.axis", ["named after no axis", "X A"]),
    ("[joints.A]", '[joints.second]\naxis = "Y"', 23, "joints.second.axis", ["'Y'", "X A"]),
    ("[joints.A]", '[joints.second]\naxis = "X"', 11, "axes.A", ["no joint drives it"]),
    ('kind = "latched"', 'kind = "timed"', 26, "io.lamp.duration", ["missing", "timed"]),
    ('kind = "latched"', 'kind = "latched"\nfrequency = "5 Hz"', 28, "io.lamp.frequency", ["only a train output"]),
    ('"10 mA"', '"20 mA"', 29, "io.lamp.load", ["16 mA", "20 mA", "open collector"]),
    ('load = "10 mA"', 'current = "20 mA"', 29, "io.lamp.current", ["16 mA", "20 mA"]),
    ('load = "10 mA"', "pin = 3\n\n[io.other]\nkind = 'input'\npin = 3", 33, "io.other.pin", ["pin 3", "io.lamp"]),
    ("[io.lamp]", '[spindle]\nmaximum = "9 rpm"\nminimum = "20 rpm"\n\n[io.lamp]', 28, "spindle.minimum", ["9 rpm"]),
    ("[io.lamp]", '[beam]\nkind = "lamp"\n\n[io.lamp]', 27, "beam.kind", ["shutter, power", "'lamp'"]),
    ("[io.lamp]", '[beam]\nkind = "power"\nfull_power = "1"\n\n[io.lamp]', 28, "beam.full_power", ["bare number"]),
    ("[io.lamp]", '[path]\nvelocity = "-1 mm/s"\n\n[io.lamp]', 27, "path.velocity", ["above zero", "-1 mm/s"]),
    ("[axes.X]", 'profile = "s-curve"\n\n[axes.X]', 7, "axes.X.jerk", ["missing", "s-curve"]),
    ("[axes.X]", 'profile = "sharp"\n\n[axes.X]', 5, "profile", ["trapezoid, s-curve, torque", "'sharp'"]),
    ("[joints.X]", '[joints.X]\nbacklash = "100 mm"', 18, "joints.X.backlash", ["less than the travel", "100"]),
    ("[joints.X]", '[joints.X]\npulse_rate = "1 MHz"', 18, "joints.X.pulse_rate", ["100000", "1e+06"]),
]  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_one_mistake_is_one_error_in_its_place(good: str, mistake: tuple[str, str, int, str, list[str]]):
    old, new, line, key, says = mistake
    assert old in good
    with pytest.raises(MachineError) as caught:
        loads(good.replace(old, new, 1), "small.toml")
    error, text = caught.value, str(caught.value)
    assert isinstance(error, ConfigError | UnitError)
    assert error.source is not None
    assert (error.source.file, error.source.line, error.key) == ("small.toml", line, key)
    assert text.startswith(f"small.toml:{line}")
    assert key in text
    for words in says:
        assert words in text


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", 1, "empty"),
        ("# nothing\n", 1, "format"),
        ("format = 1\nname = small\n", 2, "not TOML"),
        ("format = 1\nformat = 1\n", 2, "not TOML"),
        ("G0 X10\nM2\n", 1, "not TOML"),
        ('format = 1\nname = "open\n', 2, "not TOML"),
        ("format = 1\n[axes", 2, "not TOML"),
    ],
)
def test_what_is_no_machine_file_at_all(text: str, line: int, says: str):
    with pytest.raises(ConfigError, match=says) as caught:
        loads(text, "bad.toml")
    assert caught.value.source is not None
    assert (caught.value.source.file, caught.value.source.line) == ("bad.toml", line)


def test_tells_how_many_more_mistakes_there_are(good: str):
    text = good.replace('"50 mm/s"', "50").replace("microsteps = 4", "microstep = 4").replace('"10 mA"', "10")
    machine, problems = inspect_text(text, "small.toml")
    assert machine is None
    assert [problem.key for problem in problems] == ["axes.X.velocity", "joints.X.motor.microstep", "io.lamp.load"]
    with pytest.raises(UnitError, match=r"2 more mistakes: trochia machine check small.toml"):
        loads(text, "small.toml")


def test_a_wrong_axis_hides_no_mistake_of_other_tables(good: str):
    _, problems = inspect_text(good.replace('"100 mm"', "100").replace('"720 deg/s²"', '"720"'), "f")
    assert [problem.key for problem in problems] == ["axes.X.maximum", "axes.A.acceleration"]


def test_a_machine_that_does_not_exist_lists_those_that_do():
    with pytest.raises(ConfigError, match="reference-mill") as caught:
        load("xytable")
    assert caught.value.hint == "did you mean xy-table?"
    for name in shipped():
        assert name in str(caught.value)


def test_a_file_beside_is_pointed_at(good: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "mine.toml").write_text(good)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigError, match=r"mine\.toml"):
        load("mine")
    assert load("mine.toml").name == "small"


@pytest.mark.parametrize("name", ["missing.toml", "."])
def test_a_file_that_cannot_be_read(tmp_path: Path, name: str):
    machine, problems = inspect(f"{tmp_path}/{name}")
    assert machine is None
    assert "cannot read the machine file" in str(problems[0])


@pytest.mark.parametrize("data", [b"\x7fELF\x00\x01\xff\xfe", b"name = 'caf\xe9'\n", b"a\nb\0c"])
def test_binary_data_is_no_machine_file(tmp_path: Path, data: bytes):
    path = tmp_path / "binary.toml"
    path.write_bytes(data)
    with pytest.raises(ConfigError, match="expected a machine file in TOML"):
        load(path)


def test_byte_order_mark_and_crlf_are_taken(tmp_path: Path, good: str):
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + good.replace("\n", "\r\n").encode())
    assert load(path) == loads(good)


ODD = ["0", "-1", "true", '""', '"\\u0000"', "[]", "[1, 2]", "{}", "{ kind = 5 }", "1979-05-27", "nan", "inf", "1e300",
       '"1e999999999 mm"', '"1e300 m/s"', '"none"', "99999999999999999999999"]  # fmt: skip


@pytest.mark.parametrize("odd", ODD)
def test_an_odd_value_anywhere_is_an_error_or_a_machine_but_never_a_crash(good: str, odd: str):
    lines = good.splitlines()
    for number, line in enumerate(lines):
        name, equals, _ = line.partition("=")
        if equals:
            text = "\n".join([*lines[:number], f"{name}= {odd}", *lines[number + 1 :]])
            machine, problems = inspect_text(text, "odd.toml")
            assert (machine is None) == bool(problems)
            assert all(problem.source is not None for problem in problems)


@pytest.mark.parametrize("odd", ODD)
@pytest.mark.parametrize("table", ["axes", "axes.X", "joints", "joints.X", "path", "spindle", "beam", "io", "io.lamp"])
def test_an_odd_value_for_a_table_is_an_error(good: str, table: str, odd: str):
    document = re.sub(rf"^\[{re.escape(table)}(\.\w+)?\]\n(.+\n)*", "", good, flags=re.MULTILINE)
    head, _, rest = document.partition("\n\n")
    outer, _, inner = table.rpartition(".")
    document = f"{head}\n{table} = {odd}\n\n{rest}" if not outer else f"{document}\n[{outer}]\n{inner} = {odd}\n"
    machine, problems = inspect_text(document, "odd.toml")
    if odd in {"{}", "[]"} and machine is not None:
        assert table in {"path", "io", "io.lamp"}
    else:
        assert problems
