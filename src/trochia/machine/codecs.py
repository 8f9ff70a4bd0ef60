"""Codecs: a value of a machine file (TOML) to the value of a description's field, and back, exactly.

In: what TOML holds (text, whole numbers, ``Decimal``, true and false).  Out: floats in base units, Fractions, text.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from typing import TYPE_CHECKING, Any, Protocol

from trochia import units
from trochia.errors import ConfigError

if TYPE_CHECKING:
    from fractions import Fraction

_ANGULAR = {
    "length": "angle",
    "velocity": "angular velocity",
    "acceleration": "angular acceleration",
    "jerk": "angular jerk",
    "force": "torque",
    "mass": "inertia",
}
#: other units than the base one that a quantity may be written in, where that is shorter and reads back the same
_PREFERRED = {"time": ("s", "ms", "us", "ns"), "frequency": ("Hz", "kHz", "MHz"), "current": ("A", "mA")}


class Codec(Protocol):
    """A TOML value to the field's value, and back; ``rotary`` says that lengths are angles."""

    def read(self, value: object, *, rotary: bool) -> object:
        """Return the field's value; raise UnitError or ConfigError without a key."""
        ...

    def write(self, value: Any, *, rotary: bool) -> str:  # noqa: ANN401 - each codec takes its own type
        """Return TOML text that :meth:`read` reads back exactly."""
        ...

    def example(self, *, rotary: bool) -> str:
        """Return a value as it would stand in the file."""
        ...


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit, as a float in the base unit; ``motion`` makes lengths angles on rotary axes."""

    dimension: str
    motion: bool = False

    def of(self, *, rotary: bool) -> str:
        """Return the dimension asked for."""
        return _ANGULAR[self.dimension] if self.motion and rotary else self.dimension

    def read(self, value: object, *, rotary: bool) -> float:
        """Return the value in the base unit."""
        return units.parse(value, self.of(rotary=rotary))

    def write(self, value: float, *, rotary: bool) -> str:
        """Return the shortest text that reads back the same."""
        return quote(shortest(value, self.of(rotary=rotary)))

    def example(self, *, rotary: bool) -> str:
        """Return ten of the base unit."""
        return quote(f"10 {next(iter(units.UNITS[self.of(rotary=rotary)]))}")


@dataclass(frozen=True, slots=True)
class Exact:
    """A length or angle that must stay exact: a Fraction of mm or degrees."""

    dimension: str
    motion: bool = False

    def _of(self, *, rotary: bool) -> str:
        return _ANGULAR[self.dimension] if self.motion and rotary else self.dimension

    def read(self, value: object, *, rotary: bool) -> Fraction:
        """Return exactly what was typed."""
        return units.parse_fraction(value, self._of(rotary=rotary))

    def write(self, value: Fraction, *, rotary: bool) -> str:
        """Return a decimal where it is finite, else a fraction."""
        return quote(units.render_fraction(value, self._of(rotary=rotary)))

    def example(self, *, rotary: bool) -> str:
        """Return a usual one."""
        return '"360 deg"' if self._of(rotary=rotary) == "angle" else '"2 mm"'


@dataclass(frozen=True, slots=True)
class Ratio:
    """A bare number that must stay exact."""

    def read(self, value: object, *, rotary: bool) -> Fraction:
        """Return exactly what was typed: 5, "5/2" or "26:1"."""
        del rotary
        return units.parse_ratio(value)

    def write(self, value: Fraction, *, rotary: bool) -> str:
        """Return a whole number bare, else quoted."""
        del rotary
        text = units.render_fraction(value)
        return text if value.denominator == 1 else quote(text)

    def example(self, *, rotary: bool) -> str:
        """Return a usual one."""
        del rotary
        return "4096"


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number."""

    def read(self, value: object, *, rotary: bool) -> int:
        """Return it."""
        del rotary
        if not isinstance(value, int) or isinstance(value, bool):
            raise ConfigError(f"expected a whole number, like 200, not {value!r}")
        return value

    def write(self, value: int, *, rotary: bool) -> str:
        """Return its digits."""
        del rotary
        return str(value)

    def example(self, *, rotary: bool) -> str:
        """Return a usual one."""
        del rotary
        return "200"


@dataclass(frozen=True, slots=True)
class Number:
    """A bare number without dimension, as a float."""

    def read(self, value: object, *, rotary: bool) -> float:
        """Return it; a quoted number, infinity and NaN are refused."""
        del rotary
        if isinstance(value, bool) or not isinstance(value, int | Decimal) or not math.isfinite(number := float(value)):
            raise ConfigError(f"expected a bare number, like 1000, not {units.shown(value)}")
        return number

    def write(self, value: float, *, rotary: bool) -> str:
        """Return it as short as it reads back the same."""
        del rotary
        return repr(float(value))

    def example(self, *, rotary: bool) -> str:
        """Return a usual one."""
        del rotary
        return "1000"


@dataclass(frozen=True, slots=True)
class Flag:
    """True or false."""

    def read(self, value: object, *, rotary: bool) -> bool:
        """Return it."""
        del rotary
        if not isinstance(value, bool):
            raise ConfigError(f"expected true or false, without quotes, not {units.shown(value)}")
        return value

    def write(self, value: bool, *, rotary: bool) -> str:  # noqa: FBT001 - every codec's write takes its value first
        """Return TOML's word for it."""
        del rotary
        return "true" if value else "false"

    def example(self, *, rotary: bool) -> str:
        """Return a usual one."""
        del rotary
        return "true"


@dataclass(frozen=True, slots=True)
class Text:
    """Any text, or one of ``choices``; with ``as_enum`` the choice becomes a member of that Enum."""

    choices: tuple[str, ...] = ()
    as_enum: type[Enum] | None = None

    def read(self, value: object, *, rotary: bool) -> str | Enum:
        """Return the text (or member)."""
        del rotary
        if not isinstance(value, str):
            raise ConfigError(f"expected a text in quotes, not {units.shown(value)}")
        if self.choices and value not in self.choices:
            raise ConfigError(f"expected one of {', '.join(self.choices)}, not {value!r}",
                              hint=units.did_you_mean(value, self.choices))  # fmt: skip
        return self.as_enum(value) if self.as_enum else value

    def write(self, value: str | Enum, *, rotary: bool) -> str:
        """Return it in quotes."""
        del rotary
        return quote(value.value if isinstance(value, Enum) else value)

    def example(self, *, rotary: bool) -> str:
        """Return the first choice."""
        del rotary
        return quote(self.choices[0] if self.choices else "…")


def quote(text: str) -> str:
    """Return a TOML basic string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def shortest(value: float, dimension: str) -> str:
    """Return the shortest text with a unit that reads back exactly; the base unit wins a tie."""
    texts = [units.render(value, dimension)]
    for unit in _PREFERRED.get(dimension, ())[1:]:
        text = f"{value / units.UNITS[dimension][unit]:.12g} {unit}"
        if units.parse(text, dimension) == value:
            texts.append(text)
    return min(texts, key=lambda text: (len(text.partition(" ")[0]), texts.index(text)))
