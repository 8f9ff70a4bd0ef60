"""The reference page names every key of a machine file, with unit, bound, default and meaning, as the code has it."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest

from trochia.machine.acceleration import CurveOfAcceleration
from trochia.machine.axes import Axis, PathLimits
from trochia.machine.board import BoardLink
from trochia.machine.codecs import Exact, Flag, Number, Quantity, Ratio, Text, Whole
from trochia.machine.compensation import Compensation, Squareness
from trochia.machine.drivers import LAWS
from trochia.machine.error_table import TableOfErrors
from trochia.machine.homing import METHODS, Homing, LimitSwitch
from trochia.machine.io import CHANNELS, ELECTRICAL, Beam, Channel, Spindle
from trochia.machine.joints import MOTORS, Encoder, Joint, PulseTiming
from trochia.machine.kinematics import KINEMATICS
from trochia.machine.loads import JointLoad
from trochia.machine.machine import Machine
from trochia.machine.motors import CatalogueStepper
from trochia.machine.panel import Panel
from trochia.machine.probe import Part, Probe
from trochia.machine.resonance import Resonance
from trochia.machine.schema import Bound, Key, Record, Variant, keys_of
from trochia.machine.servos import LOOPS, SERVO_MOTORS, DriveTrain, NotchData, ServoAmplifier
from trochia.machine.transmissions import TRANSMISSIONS

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "machine-file.md"
TABLES = {
    "Top of the file": Machine, "path": PathLimits, "axes.X": Axis, "resonance": Resonance,
    "home": Homing, "limit_minus and limit_plus": LimitSwitch, "joints.X": Joint, "encoder": Encoder,
    "pulses": PulseTiming, "spindle": Spindle, "beam": Beam, "io.NAME": Channel, "probe": Probe, "part": Part,
    "panel": Panel, "board": BoardLink, "compensation": Compensation, "squareness and squareness_error": Squareness,
    "catalogue": CatalogueStepper, "load": JointLoad,
} | {f"motor, kind {kind}": cls for kind, cls in MOTORS.items()} | {
    f"transmission, kind {kind}": cls for kind, cls in TRANSMISSIONS.items()
} | {
    f"driver, kind {kind}": cls for kind, cls in LAWS.items()
} | {"amplifier": ServoAmplifier, "train": DriveTrain, "notch": NotchData} | {
    f"loop, kind {kind}": cls for kind, cls in LOOPS.items()
} | {
    f"catalogue, kind {kind}": cls for kind, cls in SERVO_MOTORS.items()
}  # fmt: skip
PLAIN = {Ratio: "exact number", Whole: "whole number", Number: "number", Flag: "true or false", Text: "text",
         CurveOfAcceleration: "pairs of velocity and acceleration",
         TableOfErrors: "pairs of place and error"}  # fmt: skip


def value(entry: Key) -> str:
    match entry.codec:
        case Variant(registry):
            return "table with `kind`: " + ", ".join(registry)
        case Record():
            return "table"
        case Quantity("length", motion=True):
            text = "length or angle"
        case Quantity(dimension):
            text = dimension
        case Exact(motion=motion):
            text = "exact length or angle" if motion else "exact length"
        case Text(choices) if choices:
            text = "one of " + ", ".join(choices)
        case codec:
            text = PLAIN[type(codec)]
    return text if entry.bound is Bound.ANY else f"{text}, {entry.bound.value}"


def default(cls: type[Any], name: str, entry: Key) -> str:
    given = next(field.default for field in dataclasses.fields(cls) if field.name == name)
    if given is dataclasses.MISSING:
        return "by letter" if (cls, name) == (Axis, "kind") else "required"
    if given is None or isinstance(entry.codec, Record):
        return "none"
    return f"`{entry.codec.write(given, rotary=False)}`"


def row(cls: type[Any], name: str, entry: Key) -> str:
    return f"| `{name}` | {value(entry)} | {default(cls, name, entry)} | {entry.doc} |"


@pytest.mark.parametrize("title", TABLES)
def test_every_key_has_its_row(title: str):
    cls = TABLES[title]
    _, found, section = PAGE.read_text(encoding="utf-8").partition(f"\n### {title}\n")
    assert found
    rows = [
        line
        for line in section.split("\n### ")[0].split("\n## ")[0].splitlines()
        if line.startswith("| `") and line.count("|") == 5
    ]
    assert rows == [row(cls, name, entry) for name, entry in keys_of(cls).items()]


def test_every_kind_is_named():
    text = PAGE.read_text(encoding="utf-8")
    for name, (_, meaning) in ELECTRICAL.items():
        assert f"| `{name}` | {meaning} |" in text
    for name, meaning in CHANNELS.items():
        assert f"| `{name}` | {meaning} |" in text
    for name, meaning in METHODS.items():
        assert f"| `{name}` | {meaning} |" in text
    for name in KINEMATICS:
        assert f"| `{name}` |" in text
