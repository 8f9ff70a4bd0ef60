"""Spindle, beam, and digital or analogue channels."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Spindle:
    """A spindle: greatest speed [rpm], time from rest to full speed [s] (spin-up is in proportion)."""

    maximum: float
    minimum: float = 0.0
    spin_up: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Beam:
    """A laser or the like: ``kind`` shutter (on or off) or power; S at full power; switching delay [s]."""

    kind: str
    full_power: float = 1.0
    delay: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One input or output; its electrical kind and current limit [A] are what it may be wired to."""

    name: str
    kind: str
    pin: int | None = None
    current: float | None = None
