"""Text with units to numbers in base units, and back.

Base units: axis space mm, degree, s; motor space SI (rad, N·m, A, V, Ω, H, kg·m², kg).  Which of them a text means is
decided by the *dimension* asked for, so ``"300 mm/s"`` and ``"18 m/min"`` are the same feed, and ``"2 A"`` is none.
"""

from __future__ import annotations

import difflib
import math
import re
from fractions import Fraction
from typing import TYPE_CHECKING

from trochia.errors import UnitError

if TYPE_CHECKING:
    from collections.abc import Iterable

_INCH = Fraction(254, 10)
_MINUTE = Fraction(60)

#: dimension -> unit -> factor to the base unit (the first unit of each row is the base)
UNITS: dict[str, dict[str, float]] = {}


_LENGTH: dict[str, Fraction] = {
    "mm": Fraction(1), "m": Fraction(1000), "cm": Fraction(10), "um": Fraction(1, 1000), "µm": Fraction(1, 1000),
    "nm": Fraction(1, 10**6), "in": _INCH, "mil": _INCH / 1000,
}  # fmt: skip
_ANGLE: dict[str, float] = {"deg": 1.0, "°": 1.0, "rad": 180 / math.pi, "rev": 360.0, "turn": 360.0, "arcmin": 1 / 60}
_TIME: dict[str, Fraction] = {
    "s": Fraction(1), "ms": Fraction(1, 1000), "us": Fraction(1, 10**6), "µs": Fraction(1, 10**6),
    "ns": Fraction(1, 10**9), "min": _MINUTE, "h": _MINUTE**2,
}  # fmt: skip


def _per_time(lengths: dict[str, Fraction] | dict[str, float], order: int) -> dict[str, float]:
    """Return the units ``length/time**order``; a base unit stays first."""
    tails = ["/s", "/min", "/h"] if order == 1 else [f"/s{'²³'[order - 2]}", f"/s^{order}", f"/s{order}"]
    seconds = [1, 60, 3600] if order == 1 else [1, 1, 1]
    return {
        f"{unit}{tail}": float(factor) / second
        for unit, factor in lengths.items()
        for tail, second in zip(tails, seconds, strict=True)
    }


UNITS["length"] = {unit: float(factor) for unit, factor in _LENGTH.items()}
UNITS["angle"] = dict(_ANGLE)
UNITS["time"] = {unit: float(factor) for unit, factor in _TIME.items()}
UNITS["velocity"] = _per_time(_LENGTH, 1)
UNITS["acceleration"] = _per_time(_LENGTH, 2)
UNITS["jerk"] = _per_time(_LENGTH, 3)
UNITS["angular velocity"] = _per_time(_ANGLE, 1)
UNITS["angular acceleration"] = _per_time(_ANGLE, 2)
UNITS["angular jerk"] = _per_time(_ANGLE, 3)
UNITS["rotation speed"] = {"rpm": 1.0, "rev/min": 1.0, "r/min": 1.0, "rev/s": 60.0, "Hz": 60.0}
UNITS["length per turn"] = {f"{unit}/rev": float(factor) for unit, factor in _LENGTH.items()}
UNITS["frequency"] = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6}
UNITS["current"] = {"A": 1.0, "mA": 1e-3}
UNITS["voltage"] = {"V": 1.0, "mV": 1e-3, "kV": 1e3}
UNITS["resistance"] = {"ohm": 1.0, "Ω": 1.0, "mohm": 1e-3, "mΩ": 1e-3}
UNITS["inductance"] = {"H": 1.0, "mH": 1e-3, "uH": 1e-6, "µH": 1e-6}
UNITS["torque"] = {"N·m": 1.0, "Nm": 1.0, "N·cm": 1e-2, "Ncm": 1e-2, "mN·m": 1e-3, "mNm": 1e-3, "oz·in": 7.0615518e-3}
UNITS["inertia"] = {"kg·m²": 1.0, "kg·m^2": 1.0, "kgm2": 1.0, "kg·cm²": 1e-4, "g·cm²": 1e-7, "gcm2": 1e-7}
UNITS["mass"] = {"kg": 1.0, "g": 1e-3, "t": 1e3}
UNITS["force"] = {"N": 1.0, "kN": 1e3}
UNITS["power"] = {"W": 1.0, "kW": 1e3, "mW": 1e-3}
UNITS["temperature"] = {"°C": 1.0, "degC": 1.0}

#: dimension -> unit -> factor, for what must stay exact: gearing, from the text to the integers of the firmware
_EXACT: dict[str, dict[str, Fraction]] = {
    "length": _LENGTH,
    "angle": {"deg": Fraction(1), "°": Fraction(1), "rev": Fraction(360), "turn": Fraction(360),
              "arcmin": Fraction(1, 60)},
}  # fmt: skip

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(\S.*?)?\s*\Z")
# exponents of two digits at most: an exact 1e999999999 would fill the memory
_FRACTION = re.compile(r"\s*([+-]?(?:\d+\s*/\s*\d+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,2})?))\s*(\S.*?)?\s*\Z")


def parse(text: object, dimension: str) -> float:
    """Return the value of ``text`` in the base unit of ``dimension``.

    Raises
    ------
    UnitError
        When the text is no number with a unit of that dimension; it names the units that would do.
    """
    units = UNITS[dimension]
    match = _QUANTITY.match(text) if isinstance(text, str) else None
    unit = match.group(2) if match else None
    if match is None or unit is None or unit not in units:
        raise _refusal(text, unit, dimension)
    value = float(match.group(1)) * units[unit]
    if not math.isfinite(value):
        raise UnitError(f"{text!r} is too large a {dimension}")
    return value


def parse_fraction(text: object, dimension: str) -> Fraction:
    """Return exactly what ``text`` says, in the base unit of ``dimension``: ``"0.2 in"`` is 127/25 mm.

    A fraction may be typed as one, ``"25/8 mm"``.

    Raises
    ------
    UnitError
        As :func:`parse`, and for a unit that is no exact multiple of the base (``rad``).
    """
    units = _EXACT[dimension]
    match = _FRACTION.match(text) if isinstance(text, str) else None
    unit = match.group(2) if match else None
    number = _fraction(match.group(1)) if match else None
    if number is None or unit is None or unit not in units:
        raise _refusal(text, unit, dimension, units)
    return number * units[unit]


def parse_ratio(value: object) -> Fraction:
    """Return a bare number exactly: ``5``, ``"5/2"``, ``"26:1"``, ``"0.75"``, or a ``Decimal``.

    Raises
    ------
    UnitError
        When it is none.
    """
    text = str(value).replace(":", "/") if not isinstance(value, bool) else ""
    match = _FRACTION.match(text)
    number = _fraction(match.group(1)) if match and match.group(2) is None else None
    if number is None:
        raise UnitError(f'expected a bare number, like 5 or "5/2", not {shown(value)}')
    return number


def _fraction(text: str) -> Fraction | None:
    """Return the number, or None where its denominator is zero."""
    try:
        return Fraction(text.replace(" ", ""))
    except ZeroDivisionError:
        return None


def shown(value: object) -> str:
    """Return a value of a machine file as its author wrote it: texts in quotes."""
    return repr(value) if isinstance(value, str) else str(value)


def did_you_mean(word: str, known: Iterable[str]) -> str | None:
    """Return "did you mean …?" with the nearest of the known words, or None where none is near."""
    near = difflib.get_close_matches(word, list(known), 1)
    return f"did you mean {near[0]}?" if near else None


def _refusal(text: object, unit: str | None, dimension: str, units: dict[str, Fraction] | None = None) -> UnitError:
    """Return the error for a text that is no quantity of this dimension."""
    wanted = list(units or UNITS[dimension])
    article = "an" if dimension[0] in "aeiou" else "a"
    message = f'expected {article} {dimension} with its unit, like "10 {wanted[0]}", not {shown(text)}'
    others = [name for name, row in UNITS.items() if unit in row]
    if unit and others and dimension not in others:
        message += f" ({unit} is a unit of {others[0]})"
    elif unit and (near := did_you_mean(unit, wanted)):
        message += f"; {near}"
    listed = ", ".join(wanted[:9]) + (", …" if len(wanted) > 9 else "")
    return UnitError(message, hint=f"Units that would do: {listed}")


def render(value: float, dimension: str) -> str:
    """Return ``value`` (in the base unit of ``dimension``) as text that :func:`parse` reads back exactly."""
    number = repr(float(value)).removesuffix(".0")
    return f"{number} {next(iter(UNITS[dimension]))}"


def render_fraction(value: Fraction, dimension: str | None = None) -> str:
    """Return an exact value as text that :func:`parse_fraction` (or :func:`parse_ratio`, without a dimension) reads."""
    number = _decimal(value) or str(value)
    return f"{number} {next(iter(_EXACT[dimension]))}" if dimension else number


def _decimal(value: Fraction) -> str | None:
    """Return the finite decimal expansion, up to nine places, or None."""
    scaled = value * 10**9
    if scaled.denominator != 1:
        return None
    whole, rest = divmod(abs(scaled.numerator), 10**9)
    text = f"{whole}.{rest:09d}".rstrip("0").rstrip(".")
    return f"-{text}" if value < 0 else text
