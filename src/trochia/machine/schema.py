"""How the fields of a description are written in a machine file.

In: codecs.  Out: the metadata of dataclass fields, so that one line says a field's name, type, unit, bound and meaning;
reader, writer, wizard and reference page all follow from it.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.machine.codecs import Codec


class Bound(Enum):
    """What a number may be."""

    ANY = "any number"
    NOT_ZERO = "not zero"
    NOT_NEGATIVE = "zero or more"
    POSITIVE = "above zero"

    def holds(self, value: float | Fraction) -> bool:
        """Whether the value is inside."""
        return {"ANY": True, "NOT_ZERO": value != 0, "NOT_NEGATIVE": value >= 0, "POSITIVE": value > 0}[self.name]


@dataclass(frozen=True, slots=True)
class Record:
    """A table of its own: one description inside another."""

    cls: type[Any]


@dataclass(frozen=True, slots=True)
class Variant:
    """A table whose ``kind`` chooses one class of a registry."""

    registry: Mapping[str, type[Any]]


@dataclass(frozen=True, slots=True)
class Key:
    """One key of a machine file: how it is written, what it may be, what it means."""

    codec: Codec | Record | Variant
    doc: str
    bound: Bound


def key(codec: Codec | Record | Variant, doc: str, bound: Bound = Bound.ANY) -> dict[str, Key]:
    """Return the metadata of a dataclass field that is a key of the machine file."""
    return {"key": Key(codec, doc, bound)}


def keys_of(cls: type[Any]) -> dict[str, Key]:
    """Return the keys of a description class by field name; fields without metadata are not keys."""
    return {field.name: field.metadata["key"] for field in dataclasses.fields(cls) if "key" in field.metadata}


def required(cls: type[Any], name: str) -> bool:
    """Whether the key must stand in the file."""
    field = next(field for field in dataclasses.fields(cls) if field.name == name)
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def check_bounds(description: object, *, rotary: bool = False, path: str = "") -> None:
    """Hold every field to its bound; ``path`` is the table it stands in, where the description knows it.

    Raises
    ------
    ConfigError
        Naming the field, the value and what it may be.
    """
    for name, entry in keys_of(type(description)).items():
        value = getattr(description, name)
        if value is None or isinstance(value, bool) or not isinstance(value, int | float | Fraction):
            continue
        if not math.isfinite(value) or not entry.bound.holds(value):
            assert not isinstance(entry.codec, Record | Variant)
            shown = entry.codec.write(value, rotary=rotary) if math.isfinite(value) else repr(value)
            raise ConfigError(f"must be {entry.bound.value}, not {shown}", key=f"{path}.{name}" if path else name)
