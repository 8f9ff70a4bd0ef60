"""GRBL: the answer to ``$$``, as a terminal shows it.  Version 1.1, and 0.9 with its comments in parentheses.

GRBL knows steps a mm, not screws and micro-steps: each motor is written as 200 pulses a turn and the travel that
makes of it, so the steps a mm come out exactly.
"""

from __future__ import annotations

import re
from fractions import Fraction

from trochia.errors import ConfigError, Source
from trochia.machine.importers.report import Imported, Importer, Setting, Settings, exact, quantity

_SETTING = re.compile(r"\s*(?:\[MSG:)?\s*\$(\d+)\s*=\s*([^\s()\[\];]+)")
_CHATTER = re.compile(r"\s*(ok|grbl.*|\[.*\]|<.*>|\$\$|\(.*\)|;.*|)\s*\Z", re.IGNORECASE)
_AXES = "XYZABC"
_PULSES_PER_TURN = 200
_WHY = {
    "$11": "GRBL's junction deviation; here path_tolerance and G64 P decide on corners",
    "$12": "arcs are planned as arcs, not as chords",
}


def recognises(text: str) -> bool:
    """Whether the text has GRBL's steps-a-mm settings."""
    return any(match.group(1) == "100" for match in map(_SETTING.match, text.splitlines()) if match)


def read(text: str, file: str) -> Imported:
    """Return the machine of a ``$$`` answer."""
    settings = Settings(_settings(text), file)
    result = Imported()
    axes = {letter: n for n, letter in enumerate(_AXES) if _axis(settings, result, n, letter)}
    if not axes:
        raise ConfigError("expected GRBL's settings $100, $110, $120, $130 and on, found no whole axis",
                          source=Source(file, 1), hint="Send $$ to the board and save all of its answer.")  # fmt: skip
    result.document |= {"kinematics": "cartesian", "dialect": "grbl"}
    _pulses(settings, result, axes)
    _tool(settings, result)
    for name, why in _WHY.items():
        settings.leave("", name, why)
    result.assumed += [
        f"kinematics cartesian; a CoreXY build of GRBL looks the same in $$ ({file} does not say)",
        "travel from minus the maximum to 0, GRBL's machine coordinates after homing",
        f"{_PULSES_PER_TURN} pulses a turn of each motor; only the steps a mm are known, and they are exact",
    ]
    result.unmapped = settings.unmapped()
    return result


def _settings(text: str) -> list[Setting]:
    """Return the settings; a line that is neither one nor GRBL's chatter is a setting no one will take."""
    found: list[Setting] = []
    for number, line in enumerate(text.splitlines(), 1):
        if match := _SETTING.match(line):
            found.append(Setting(section="", name=f"${match.group(1)}", value=match.group(2), line=number))
        elif not _CHATTER.match(line):
            found.append(Setting(section="", name=line.strip(), value="", line=number))
    return found


def _axis(settings: Settings, result: Imported, n: int, letter: str) -> bool:
    """Write one axis with its joint, if its four settings are there and it can move."""
    names = [f"${base + n}" for base in (100, 110, 120, 130)]
    values = [settings.number("", name) for name in names]
    if any(value is None or value <= 0 for value in values):
        bad = [name for name, value in zip(names, values, strict=True) if value is None or value <= 0]
        for name in names:
            settings.leave("", name, f"axis {letter} left out: {', '.join(bad)} missing or not above zero")
        return False
    steps, rate, acceleration, travel = (Fraction(value or 0) for value in values)
    unit = "deg" if letter in "ABC" else "mm"
    result.document.setdefault("axes", {})[letter] = {
        "minimum": quantity(-travel, unit),
        "maximum": f"0 {unit}",
        "velocity": quantity(rate, f"{unit}/min"),
        "acceleration": quantity(acceleration, f"{unit}/s²"),
    }
    result.document.setdefault("joints", {})[letter] = {
        "motor": {"kind": "stepper", "full_steps": _PULSES_PER_TURN},
        "transmission": {"kind": "travel", "per_turn": exact(_PULSES_PER_TURN / steps, unit)},
    }
    return True


def _pulses(settings: Settings, result: Imported, axes: dict[str, int]) -> None:
    """Write pulse length ($0, in µs) and direction ($3, a bit an axis)."""
    length = settings.number("", "$0")
    inverted = settings.number("", "$3")
    for letter, n in axes.items():
        joint = result.document["joints"][letter]
        if length:
            joint["pulses"] = {"length": quantity(length, "us")}
        if inverted is not None and int(inverted) >> n & 1:
            joint["transmission"]["ratio"] = -1


def _tool(settings: Settings, result: Imported) -> None:
    """Write a beam in laser mode ($32), else a spindle, with the S at full ($30) and least ($31)."""
    laser = settings.number("", "$32")
    greatest = settings.number("", "$30")
    if laser:
        result.document["beam"] = {"kind": "power", **({"full_power": int(greatest)} if greatest else {})}
        result.assumed.append("beam of kind power: $32 is laser mode")
        return
    least = settings.number("", "$31")
    if greatest:
        result.document["spindle"] = {
            "maximum": quantity(greatest, "rpm"),
            "minimum": quantity(least or Fraction(0), "rpm"),
        }


GRBL = Importer(kind="grbl", title="GRBL's answer to $$", recognises=recognises, read=read)
