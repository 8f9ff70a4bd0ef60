"""Transmissions: turns of a motor to travel of a joint, exactly (``Fraction``), each kind one class."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol


class Transmission(Protocol):
    """Anything between a motor's shaft and its joint."""

    @property
    def travel_per_turn(self) -> Fraction:
        """Travel of the joint for one turn of the motor [mm or degree]; negative when it runs the other way."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Leadscrew:
    """A screw of the given lead [mm/rev]; ``ratio`` turns of the motor make one of the screw."""

    lead: Fraction
    ratio: Fraction = Fraction(1)

    @property
    def travel_per_turn(self) -> Fraction:
        """Lead over ratio [mm]."""
        return self.lead / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Belt:
    """A toothed belt: pitch [mm] times teeth of the pulley a turn."""

    pitch: Fraction
    teeth: int
    ratio: Fraction = Fraction(1)

    @property
    def travel_per_turn(self) -> Fraction:
        """Pitch times teeth over ratio [mm]."""
        return self.pitch * self.teeth / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Rack:
    """Rack and pinion: tooth pitch [mm] (module times pi, as measured) times teeth of the pinion a turn."""

    pitch: Fraction
    teeth: int
    ratio: Fraction = Fraction(1)

    @property
    def travel_per_turn(self) -> Fraction:
        """Pitch times teeth over ratio [mm]."""
        return self.pitch * self.teeth / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Direct:
    """A rotary joint on the motor's shaft or a gearbox: 360 degrees over ratio a turn."""

    ratio: Fraction = Fraction(1)

    @property
    def travel_per_turn(self) -> Fraction:
        """360 over ratio [degree]."""
        return 360 / self.ratio


TRANSMISSIONS: dict[str, type[Leadscrew | Belt | Rack | Direct]] = {
    "leadscrew": Leadscrew,
    "belt": Belt,
    "rack": Rack,
    "direct": Direct,
}
