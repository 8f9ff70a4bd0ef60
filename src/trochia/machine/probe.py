"""A touch probe, and what the digital twin's meets."""

from __future__ import annotations

from dataclasses import dataclass, field

from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity, Text
from trochia.machine.schema import Record, key


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """What the twin's probe meets: the inside of as many planes as are given, machine coordinates [mm]."""

    left: float | None = field(default=None, metadata=key(Quantity("length"), "its least X"))
    right: float | None = field(default=None, metadata=key(Quantity("length"), "its greatest X"))
    front: float | None = field(default=None, metadata=key(Quantity("length"), "its least Y"))
    back: float | None = field(default=None, metadata=key(Quantity("length"), "its greatest Y"))
    top: float | None = field(default=None, metadata=key(Quantity("length"), "its greatest Z"))

    def __post_init__(self) -> None:
        for low, high in (("left", "right"), ("front", "back")):
            first, last = getattr(self, low), getattr(self, high)
            if first is not None and last is not None and first >= last:
                raise ConfigError(f"must lie beyond {low} ({first:g} mm), not at {last:g} mm", key=f"probe.part.{high}")
        if all(getattr(self, name) is None for name in self.__slots__):
            raise ConfigError("needs one bound at least", key="probe.part", hint='Like part = { top = "-10 mm" }.')


@dataclass(frozen=True, slots=True, kw_only=True)
class Probe:
    """A touch probe: its input is active while it touches."""

    input: str = field(metadata=key(Text(), "name of its input under [io]"))
    part: Part | None = field(default=None, metadata=key(Record(Part), "what the digital twin's probe meets"))
