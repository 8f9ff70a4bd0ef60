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
    from collections.abc import Iterable, Mapping

_INCH = Fraction(254, 10)
_MINUTE = Fraction(60)

Factor = Fraction | float  #: exact wherever a unit is a rational multiple of its base, so that 6 in is 152.4 mm

#: dimension -> unit -> factor to the base unit (the first unit of each row is the base)
_FACTORS: dict[str, dict[str, Factor]] = {}


_LENGTH: dict[str, Fraction] = {
    "mm": Fraction(1), "m": Fraction(1000), "cm": Fraction(10), "um": Fraction(1, 1000), "µm": Fraction(1, 1000),
    "nm": Fraction(1, 10**6), "in": _INCH, "mil": _INCH / 1000,
}  # fmt: skip
_ANGLE: dict[str, Factor] = {
    "deg": Fraction(1), "°": Fraction(1), "rad": 180 / math.pi, "rev": Fraction(360), "turn": Fraction(360),
    "arcmin": Fraction(1, 60),
}  # fmt: skip
_TIME: dict[str, Fraction] = {
    "s": Fraction(1), "ms": Fraction(1, 1000), "us": Fraction(1, 10**6), "µs": Fraction(1, 10**6),
    "ns": Fraction(1, 10**9), "min": _MINUTE, "h": _MINUTE**2,
}  # fmt: skip


def _per_time(lengths: Mapping[str, Factor], order: int) -> dict[str, Factor]:
    """Return the units ``length/time**order``; a base unit stays first."""
    tails = ["/s", "/min", "/h"] if order == 1 else [f"/s{'²³'[order - 2]}", f"/s^{order}", f"/s{order}"]
    seconds = [1, 60, 3600] if order == 1 else [1, 1, 1]
    return {
        f"{unit}{tail}": factor / second
        for unit, factor in lengths.items()
        for tail, second in zip(tails, seconds, strict=True)
    }


_FACTORS["length"] = {**_LENGTH}
_FACTORS["angle"] = {**_ANGLE}
_FACTORS["time"] = {**_TIME}
_FACTORS["velocity"] = _per_time(_LENGTH, 1)
_FACTORS["acceleration"] = _per_time(_LENGTH, 2)
_FACTORS["jerk"] = _per_time(_LENGTH, 3)
_FACTORS["angular velocity"] = _per_time(_ANGLE, 1)
_FACTORS["angular acceleration"] = _per_time(_ANGLE, 2)
_FACTORS["angular jerk"] = _per_time(_ANGLE, 3)
_FACTORS["rotation speed"] = {"rpm": 1.0, "rev/min": 1.0, "r/min": 1.0, "rev/s": 60.0, "Hz": 60.0}
_FACTORS["length per turn"] = {f"{unit}/rev": factor for unit, factor in _LENGTH.items()}
_FACTORS["frequency"] = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6}
_FACTORS["current"] = {"A": 1.0, "mA": 1e-3}
_FACTORS["voltage"] = {"V": 1.0, "mV": 1e-3, "kV": 1e3}
_FACTORS["resistance"] = {"ohm": 1.0, "Ω": 1.0, "mohm": 1e-3, "mΩ": 1e-3}
_FACTORS["inductance"] = {"H": 1.0, "mH": 1e-3, "uH": 1e-6, "µH": 1e-6}
_FACTORS["torque"] = {
    "N·m": 1.0,
    "Nm": 1.0,
    "N·cm": 1e-2,
    "Ncm": 1e-2,
    "mN·m": 1e-3,
    "mNm": 1e-3,
    "oz·in": 7.0615518e-3,
    "kgf·cm": 9.80665e-2,
    "kg·cm": 9.80665e-2,
    "gf·cm": 9.80665e-5,
    "g·cm": 9.80665e-5,
}
_FACTORS["inertia"] = {
    "kg·m²": 1.0,
    "kg·m^2": 1.0,
    "kgm2": 1.0,
    "kg·cm²": 1e-4,
    "g·cm²": 1e-7,
    "gcm2": 1e-7,
    "oz·in²": 1.8289977e-5,
}
_FACTORS["mass"] = {"kg": 1.0, "g": 1e-3, "t": 1e3}
_FACTORS["force"] = {"N": 1.0, "kN": 1e3}
_FACTORS["power"] = {"W": 1.0, "kW": 1e3, "mW": 1e-3}
_KRPM = 60 / (2 * math.pi * 1000)  #: of 1 rad/s, in thousands of rpm
_FACTORS["torque constant"] = {"N·m/A": 1.0, "Nm/A": 1.0, "mN·m/A": 1e-3, "mNm/A": 1e-3}
_FACTORS["emf constant"] = {"V·s/rad": 1.0, "Vs/rad": 1.0, "mV·s/rad": 1e-3, "V/krpm": _KRPM, "mV/rpm": _KRPM}
_FACTORS["viscous friction"] = {"N·m·s/rad": 1.0, "Nms/rad": 1.0, "mN·m/krpm": 1e-3 * _KRPM}
_FACTORS["stiffness"] = {"N·m/rad": 1.0, "Nm/rad": 1.0}
_FACTORS["rate"] = {"1/s": 1.0}
_FACTORS["position gain"] = {"V/rad": 1.0, "mV/rad": 1e-3}
_FACTORS["integral gain"] = {"V/(rad·s)": 1.0}
_FACTORS["temperature"] = {"°C": 1.0, "degC": 1.0}

#: dimension -> unit -> factor, as floats
UNITS: dict[str, dict[str, float]] = {
    dimension: {unit: float(factor) for unit, factor in row.items()} for dimension, row in _FACTORS.items()
}
#: the same for what must stay exact: gearing, from the text to the integers of the firmware
_EXACT: dict[str, dict[str, Fraction]] = {
    dimension: {unit: factor for unit, factor in _FACTORS[dimension].items() if isinstance(factor, Fraction)}
    for dimension in ("length", "angle")
}

# exponents of three digits at most: an exact 1e999999999 would fill the memory
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(\S.*?)?\s*\Z")
#: as catalogues print a product and a power, and keyboards have them: N.cm, oz-in, g*cm^2
_PRODUCT, _SQUARE = re.compile(r"(?<=[A-Za-z])[.*•⋅-](?=[A-Za-z])"), re.compile(r"(?<=[A-Za-z])\^?2\Z")
_FRACTION = re.compile(rf"\s*([+-]?\d+\s*/\s*\d+|{_NUMBER})\s*(\S.*?)?\s*\Z")


def parse(text: object, dimension: str) -> float:
    """Return the value of ``text`` in the base unit of ``dimension``.

    Raises
    ------
    UnitError
        When the text is no number with a unit of that dimension; it names the units that would do.
    """
    units = _FACTORS[dimension]
    match = _QUANTITY.match(text) if isinstance(text, str) else None
    unit = match.group(2) if match else None
    if unit is not None and unit not in units:
        unit = _SQUARE.sub("²", _PRODUCT.sub("·", unit))
    if match is None or unit is None or unit not in units:
        raise _refusal(text, match.group(2) if match else None, dimension)
    factor = units[unit]
    try:
        if isinstance(factor, Fraction):
            return float(Fraction(match.group(1)) * factor)  # rounded once
        value = float(match.group(1)) * factor
    except OverflowError:
        value = math.inf
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


def _refusal(text: object, unit: str | None, dimension: str, units: Mapping[str, Fraction] | None = None) -> UnitError:
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
