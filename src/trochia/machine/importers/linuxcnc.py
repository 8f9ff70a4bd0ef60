"""LinuxCNC: an ini file, of 2.8 and later ([AXIS_X] and [JOINT_0]) or older ([AXIS_0] for both).

SCALE is pulses a machine unit; screws and micro-steps are not in the file.  A stepper is written as 200 pulses a turn
and the travel that makes of it, so the steps a mm come out exactly; a servo's encoder as counts a mm.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from trochia.errors import ConfigError, Source
from trochia.machine.axes import LETTERS
from trochia.machine.importers import ini
from trochia.machine.importers.report import Imported, Importer, Setting, Settings, Unmapped, exact, quantity
from trochia.units import render_fraction

_PULSES_PER_TURN = 200
_INCH = Fraction(254, 10)
_KINEMATICS = {"trivkins": "cartesian", "corexykins": "corexy"}
_STEPPED = ("STEPGEN_MAXVEL", "STEPGEN_MAXACCEL", "STEPLEN", "STEPSPACE", "STEP_SCALE")
_COUNTED = ("ENCODER_SCALE", "OUTPUT_SCALE", "P")
_TIMES = {"length": "STEPLEN", "space": "STEPSPACE", "setup": "DIRSETUP", "hold": "DIRHOLD"}


@dataclass(frozen=True, slots=True)
class _Unit:
    """The file's unit along one kind of axis: its name here, and its size in mm or degrees."""

    name: str
    size: Fraction


_DEGREE = _Unit("deg", Fraction(1))


def recognises(text: str) -> bool:
    """Whether the text has LinuxCNC's sections."""
    return bool(re.search(r"^\s*\[(TRAJ|KINS|EMCMOT)\]", text, re.MULTILINE))


def read(text: str, file: str) -> Imported:
    """Return the machine of an ini file."""
    settings = Settings(ini.settings(text, separators="=", continued="backslash"), file, first_wins=True)
    result = Imported()
    linear = _linear_unit(settings, result)
    letters = _kinematics(settings, result)
    joints = _joint_letters(settings, result, letters)
    for letter in dict.fromkeys(letters):
        _axis(settings, result, letter, letters.index(letter), _unit(letter, linear))
    for index, letter in enumerate(joints):
        _joint(settings, result, index, letter, _unit(letter, linear))
    _path(settings, result, linear)
    _spindle(settings, result)
    if name := settings.take("EMC", "MACHINE"):
        result.document["description"] = name.value
    result.unmapped = sorted(result.unmapped + settings.unmapped(), key=lambda each: each.setting.line)
    return result


def _unit(letter: str, linear: _Unit) -> _Unit:
    """Return the unit of an axis."""
    return _DEGREE if letter in "ABC" else linear


def _linear_unit(settings: Settings, result: Imported) -> _Unit:
    """Return mm or inch; angles must be in degrees."""
    angle = settings.take("TRAJ", "ANGULAR_UNITS")
    if angle and not angle.value.lower().startswith("deg"):
        raise settings.error(
            angle, f"expected degree, not {angle.value!r}", hint="Other angles cannot be imported yet."
        )
    setting = settings.take("TRAJ", "LINEAR_UNITS")
    if setting is None:
        result.assume("lengths in mm: [TRAJ]LINEAR_UNITS is not there")
        return _Unit("mm", Fraction(1))
    word = setting.value.split()[0].lower() if setting.value else ""
    if word in {"mm", "metric"}:
        return _Unit("mm", Fraction(1))
    if word in {"in", "inch", "imperial"}:
        return _Unit("in", _INCH)
    raise settings.error(setting, f"expected mm or inch, not {setting.value!r}")


def _kinematics(settings: Settings, result: Imported) -> list[str]:
    """Write the kinematics and return the letter of each joint (trivkins coordinates=XYYZ), or of each axis."""
    setting = settings.take("KINS", "KINEMATICS")
    words = setting.value.split() if setting and setting.value else ["trivkins"]
    if setting is None:
        result.assume("kinematics cartesian: [KINS]KINEMATICS is not there")
    if words[0] not in _KINEMATICS:
        assert setting is not None
        raise settings.error(setting, f"expected one of {', '.join(_KINEMATICS)}, not {words[0]!r}",
                             hint="Other kinematics cannot be imported yet.")  # fmt: skip
    lathe = settings.take("DISPLAY", "LATHE")
    is_lathe = lathe is not None and lathe.value.lower() in {"1", "yes", "true"}
    result.document["kinematics"] = "lathe" if is_lathe else _KINEMATICS[words[0]]
    for word in words[1:]:
        if setting and not word.lower().startswith("coordinates="):
            rest = Setting(section="KINS", name="KINEMATICS", value=word, line=setting.line)
            result.unmapped.append(Unmapped(setting=rest, why="only its coordinates= is taken"))
    named = next((word.partition("=")[2] for word in words[1:] if word.lower().startswith("coordinates=")), "")
    coordinates = settings.take("TRAJ", "COORDINATES")
    letters = [c for c in (named or (coordinates.value if coordinates else "XYZ")).upper() if not c.isspace()]
    if not letters or any(letter not in LETTERS for letter in letters):
        raise ConfigError(f"expected axis letters as coordinates, not {''.join(letters)!r}",
                          source=Source(settings.file, coordinates.line if coordinates else 1))  # fmt: skip
    return letters


def _joint_letters(settings: Settings, result: Imported, letters: list[str]) -> list[str]:
    """Return the letter of each joint, as many as [KINS]JOINTS says."""
    count = settings.number("KINS", "JOINTS")
    if count is not None and int(count) != len(letters):
        result.assume(f"{len(letters)} joints, one for each coordinate: [KINS]JOINTS says {count}")
    settings.take("TRAJ", "AXES")  # the older files' count
    return letters


def _axis(settings: Settings, result: Imported, letter: str, index: int, unit: _Unit) -> None:
    """Write one axis from [AXIS_X], else [JOINT_n], else the older [AXIS_n]."""
    sections = (f"AXIS_{letter}", f"JOINT_{index}", f"AXIS_{index}")

    def value(*names: str) -> Fraction:
        for section in sections:
            if (number := settings.number(section, *names)) is not None:
                return number
        raise ConfigError(f"axis {letter}: no {names[0]} in {', '.join(f'[{s}]' for s in sections)}",
                          source=Source(settings.file, 1), hint="Give it in the file, or with --set.")  # fmt: skip

    axis = {
        "minimum": quantity(value("MIN_LIMIT"), unit.name),
        "maximum": quantity(value("MAX_LIMIT"), unit.name),
        "velocity": quantity(value("MAX_VELOCITY"), f"{unit.name}/s"),
        "acceleration": quantity(value("MAX_ACCELERATION"), f"{unit.name}/s²"),
    }
    jerk = settings.number(sections[0], "MAX_JERK") or settings.number(sections[1], "MAX_JERK")
    if jerk:
        axis["jerk"] = quantity(jerk, f"{unit.name}/s³")
    result.document.setdefault("axes", {})[letter] = axis


def _joint(settings: Settings, result: Imported, index: int, letter: str, unit: _Unit) -> None:
    """Write one joint from [JOINT_n], else the older [AXIS_n]."""
    joints: dict[str, Any] = result.document.setdefault("joints", {})
    has_own = f"JOINT_{index}" in settings.sections()
    section = f"JOINT_{index}" if has_own else f"AXIS_{index}"
    joint = _drive(settings, result, section, unit)
    if backlash := settings.number(section, "BACKLASH"):
        joint["backlash"] = quantity(backlash, unit.name)
    if has_own:
        for name in ("MIN_LIMIT", "MAX_LIMIT"):
            if settings.find(f"AXIS_{letter}", name):
                settings.leave(section, name, "the travel of the axis binds")
        for key, name, tail in (("velocity", "MAX_VELOCITY", "/s"), ("acceleration", "MAX_ACCELERATION", "/s²")):
            if limit := settings.number(section, name):
                joint[key] = quantity(limit, f"{unit.name}{tail}")
    pulses = {key: settings.number(section, name) for key, name in _TIMES.items()}
    if joint["motor"]["kind"] == "stepper" and any(pulses.values()):
        joint["pulses"] = {key: quantity(time, "ns") for key, time in pulses.items() if time}
    settings.take(section, "TYPE")
    if letter not in joints and result.document["kinematics"] != "corexy":
        joints[letter] = joint
    else:
        belt = result.document["kinematics"] == "corexy" and index < 2
        joints[f"joint-{index}"] = joint if belt else {"axis": letter, **joint}


def _drive(settings: Settings, result: Imported, section: str, unit: _Unit) -> dict[str, Any]:
    """Return motor, transmission and encoder, by the scales the section gives."""
    for name in ("P", "I", "D", "FF0", "FF1", "FF2", "OUTPUT_SCALE"):
        settings.leave(section, name, "of the servo loop, not of the machine")
    settings.leave(section, "STEPGEN_MAXVEL", "head-room of the step generator; here the axis' own limits bind")
    settings.leave(section, "STEPGEN_MAXACCEL", "head-room of the step generator; here the axis' own limits bind")
    stepped = any(settings.find(section, name) for name in _STEPPED)
    counted = any(settings.find(section, name) for name in _COUNTED)
    encoder: dict[str, Any] = {}
    if counted and (
        counts := settings.number(section, "ENCODER_SCALE", *(() if stepped else ("INPUT_SCALE", "SCALE")))
    ):
        encoder = {"encoder": {"counts": render_fraction(counts / unit.size), "on_load": True}}
    scale = settings.number(section, "STEP_SCALE", "SCALE", "INPUT_SCALE") if stepped or not counted else None
    if not scale:
        result.assume(f"[{section}] says nothing of its screw: a servo, 1 {unit.name} a turn")
        return {"motor": {"kind": "servo"}, "transmission": {"kind": "travel", "per_turn": f"1 {unit.name}"}, **encoder}
    result.assume(f"{_PULSES_PER_TURN} pulses a turn of each stepper; the steps a unit are known, and exact")
    travel = exact(_PULSES_PER_TURN * unit.size / abs(scale), "deg" if unit is _DEGREE else "mm")
    transmission: dict[str, Any] = {"kind": "travel", "per_turn": travel}
    if scale < 0:
        transmission["ratio"] = -1
    return {"motor": {"kind": "stepper", "full_steps": _PULSES_PER_TURN}, "transmission": transmission, **encoder}


def _path(settings: Settings, result: Imported, unit: _Unit) -> None:
    """Write the caps along the path and the servo period."""
    for key, names, tail in (
        ("velocity", ("MAX_LINEAR_VELOCITY", "MAX_VELOCITY"), "/s"),
        ("acceleration", ("MAX_LINEAR_ACCELERATION", "MAX_ACCELERATION"), "/s²"),
        ("jerk", ("MAX_LINEAR_JERK",), "/s³"),
    ):
        if cap := settings.number("TRAJ", *names):
            result.document.setdefault("path", {})[key] = quantity(cap, f"{unit.name}{tail}")
    if period := settings.number("EMCMOT", "SERVO_PERIOD"):
        result.document["servo_period"] = quantity(period, "ns")


def _spindle(settings: Settings, result: Imported) -> None:
    """Write the spindle's speeds."""
    greatest = settings.number("SPINDLE_0", "MAX_FORWARD_VELOCITY", "MAX_VELOCITY")
    least = settings.number("SPINDLE_0", "MIN_FORWARD_VELOCITY", "MIN_VELOCITY")
    if greatest:
        result.document["spindle"] = {
            "maximum": quantity(greatest, "rpm"),
            "minimum": quantity(least or Fraction(0), "rpm"),
        }


LINUXCNC = Importer(kind="linuxcnc", title="a LinuxCNC ini file", recognises=recognises, read=read)
