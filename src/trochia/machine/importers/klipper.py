"""Klipper: a printer.cfg, cartesian or corexy.

Here screws, belts and micro-steps are known: rotation_distance is the travel of one turn behind the gear_ratio.
Velocity and acceleration are limits along the path; they are written as such, and as each axis' own.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from trochia.errors import ConfigError, Source
from trochia.machine.importers import ini
from trochia.machine.importers.report import Imported, Importer, Setting, Settings, exact, quantity
from trochia.units import render_fraction

_KINEMATICS = ("cartesian", "corexy")
_STEPPER = re.compile(r"stepper_([xyz])(\d*)\Z")


def recognises(text: str) -> bool:
    """Whether the text has Klipper's sections."""
    return bool(re.search(r"^\[(printer|stepper_x)\]", text, re.MULTILINE))


def read(text: str, file: str) -> Imported:
    """Return the machine of a printer.cfg."""
    found = ini.settings(text, separators=":=", inline_comments="#;", continued="indent")
    settings = Settings([_lower(setting) for setting in found], file)
    result = Imported()
    printer = _printer(settings, result)
    steppers = {name: match for name in settings.sections() if (match := _STEPPER.match(name))}
    if not steppers:
        raise ConfigError("expected sections [stepper_x], [stepper_y] and on", source=Source(file, 1))
    for name, match in steppers.items():
        if not match.group(2):
            _axis(settings, result, name, match.group(1).upper(), printer)
    for name, match in _belts_first(steppers).items():
        _joint(settings, result, name, match.group(1).upper(), match.group(2))
    result.assume("each axis' own velocity and acceleration: those Klipper gives along the path")
    result.unmapped = settings.unmapped()
    return result


def _lower(setting: Setting) -> Setting:
    """Return the setting with its name in lower case, as Klipper reads it."""
    return Setting(section=setting.section, name=setting.name.lower(), value=setting.value, line=setting.line)


def _belts_first(steppers: dict[str, re.Match[str]]) -> dict[str, re.Match[str]]:
    """Return the sections with X and Y in front, then what else drives them, then Z."""
    return dict(sorted(steppers.items(), key=lambda item: (item[1].group(2) != "", item[0])))


def _printer(settings: Settings, result: Imported) -> dict[str, Fraction]:
    """Write kinematics and path limits; return the limits by Klipper's names."""
    kinematics = settings.take("printer", "kinematics")
    if kinematics is None:
        raise settings.missing("printer", "kinematics")
    if kinematics.value not in _KINEMATICS:
        raise settings.error(kinematics, f"expected one of {', '.join(_KINEMATICS)}, not {kinematics.value!r}",
                             hint="Other kinematics cannot be imported yet.")  # fmt: skip
    result.document |= {"kinematics": kinematics.value, "dialect": "marlin"}  # whose G-code Klipper reads
    limits: dict[str, Fraction] = {}
    for name in ("max_velocity", "max_accel", "max_z_velocity", "max_z_accel"):
        if (value := settings.number("printer", name)) is not None:
            limits[name] = value
    for name in ("max_velocity", "max_accel"):
        if name not in limits:
            raise settings.missing("printer", name)
    result.document["path"] = {
        "velocity": quantity(limits["max_velocity"], "mm/s"),
        "acceleration": quantity(limits["max_accel"], "mm/s²"),
    }
    settings.leave("printer", "square_corner_velocity", "here path_tolerance and G64 P decide on corners")
    return limits


def _axis(settings: Settings, result: Imported, section: str, letter: str, limits: dict[str, Fraction]) -> None:
    """Write one axis; Klipper's default for position_min is 0."""
    greatest = settings.number(section, "position_max")
    if greatest is None:
        raise settings.missing(section, "position_max")
    velocity, acceleration = limits["max_velocity"], limits["max_accel"]
    if letter == "Z":
        velocity = limits.get("max_z_velocity", velocity)
        acceleration = limits.get("max_z_accel", acceleration)
    result.document.setdefault("axes", {})[letter] = {
        "minimum": quantity(settings.number(section, "position_min") or Fraction(0), "mm"),
        "maximum": quantity(greatest, "mm"),
        "velocity": quantity(velocity, "mm/s"),
        "acceleration": quantity(acceleration, "mm/s²"),
    }


def _joint(settings: Settings, result: Imported, section: str, letter: str, number: str) -> None:
    """Write one stepper; a numbered one helps the axis of its letter."""
    full_steps = settings.number(section, "full_steps_per_rotation")
    microsteps = settings.number(section, "microsteps")
    stepper: dict[str, Any] = {"kind": "stepper", "full_steps": int(full_steps or 200)}
    transmission = _transmission(settings, section)
    if microsteps:
        stepper["microsteps"] = int(microsteps)
    else:
        transmission = _step_distance(settings, result, section, stepper)
    if transmission is None:
        raise settings.missing(section, "rotation_distance and microsteps")
    if any(line.value.lstrip().startswith("!") for line in settings.find(section, "dir_pin")):
        transmission["ratio"] = render_fraction(-Fraction(transmission.get("ratio", 1)))
        settings.leave(section, "dir_pin", "its pin; that it is inverted is kept as a negative ratio")
    joint: dict[str, Any] = {"motor": stepper, "transmission": transmission}
    if pulse := settings.number(section, "step_pulse_duration"):
        joint["pulses"] = {"length": quantity(pulse, "s")}
    elif any(name.startswith("tmc") and name.endswith(f" {section}") for name in settings.sections()):
        joint["pulses"] = {"length": "100 ns", "space": "100 ns"}
        result.assume("pulses of 100 ns for TMC drivers, as Klipper gives them")
    belt = result.document["kinematics"] == "corexy" and letter in "XY"
    if belt and number:
        raise settings.missing(section, "no second motor on a belt", hint="Such a corexy cannot be imported yet.")
    name = {"X": "belt-a", "Y": "belt-b"}[letter] if belt else f"{letter}{number}"
    result.document.setdefault("joints", {})[name] = {"axis": letter, **joint} if number else joint


def _transmission(settings: Settings, section: str) -> dict[str, Any] | None:
    """Return rotation_distance with gear_ratio, or None."""
    distance = settings.number(section, "rotation_distance")
    if not distance:
        return None
    transmission: dict[str, Any] = {"kind": "travel", "per_turn": exact(abs(distance), "mm")}
    ratio = Fraction(1) if distance > 0 else Fraction(-1)
    if gears := settings.take(section, "gear_ratio"):
        for pair in gears.value.split(","):
            turns = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*:\s*(\d+(?:\.\d+)?)\s*", pair)
            if turns is None or not float(turns.group(1)) * float(turns.group(2)):
                raise settings.error(gears, f'expected pairs like "80:16, 57:11", not {gears.value!r}')
            ratio *= Fraction(turns.group(1)) / Fraction(turns.group(2))
    if ratio != 1:
        transmission["ratio"] = render_fraction(ratio)
    return transmission


def _step_distance(
    settings: Settings, result: Imported, section: str, stepper: dict[str, Any]
) -> dict[str, Any] | None:
    """Return the transmission of the older step_distance (travel of one micro-step), or None."""
    distance = settings.number(section, "step_distance")
    if not distance:
        return None
    result.assume(f"[{section}]: {stepper['full_steps']} pulses a turn; only step_distance is known, and exact")
    return {"kind": "travel", "per_turn": exact(distance * stepper["full_steps"], "mm")}


KLIPPER = Importer(kind="klipper", title="a Klipper printer.cfg", recognises=recognises, read=read)
