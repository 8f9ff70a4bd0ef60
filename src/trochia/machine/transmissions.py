"""Transmissions: turns of a motor to travel of a joint, exactly (``Fraction``), each kind one class."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar, Protocol

from trochia.machine.axes import AxisKind
from trochia.machine.codecs import Exact, Ratio, Whole
from trochia.machine.schema import Bound, check_bounds, key

_RATIO = key(Ratio(), "turns of the motor for one turn behind the gear; negative runs the other way", Bound.NOT_ZERO)
_TEETH = key(Whole(), "teeth of the pulley or pinion", Bound.POSITIVE)
_PITCH = key(Exact("length"), "from tooth to tooth", Bound.POSITIVE)


class Transmission(Protocol):
    """Anything between a motor's shaft and its joint."""

    kind: ClassVar[str]
    moves: ClassVar[AxisKind | None]  #: what its joint is measured in; None suits both

    @property
    def travel_per_turn(self) -> Fraction:
        """Travel of the joint for one turn of the motor [mm or degree]; negative when it runs the other way."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Leadscrew:
    """A screw of the given lead [mm/rev]; ``ratio`` turns of the motor make one of the screw."""

    kind: ClassVar[str] = "leadscrew"
    moves: ClassVar[AxisKind | None] = AxisKind.LINEAR

    lead: Fraction = field(metadata=key(Exact("length"), "travel of the nut for one turn of the screw", Bound.POSITIVE))
    ratio: Fraction = field(default=Fraction(1), metadata=_RATIO)

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def travel_per_turn(self) -> Fraction:
        """Lead over ratio [mm]."""
        return self.lead / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Belt:
    """A toothed belt: pitch [mm] times teeth of the pulley a turn."""

    kind: ClassVar[str] = "belt"
    moves: ClassVar[AxisKind | None] = AxisKind.LINEAR

    pitch: Fraction = field(metadata=_PITCH)
    teeth: int = field(metadata=_TEETH)
    ratio: Fraction = field(default=Fraction(1), metadata=_RATIO)

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def travel_per_turn(self) -> Fraction:
        """Pitch times teeth over ratio [mm]."""
        return self.pitch * self.teeth / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Rack:
    """Rack and pinion: tooth pitch [mm] (module times pi, as measured) times teeth of the pinion a turn."""

    kind: ClassVar[str] = "rack"
    moves: ClassVar[AxisKind | None] = AxisKind.LINEAR

    pitch: Fraction = field(metadata=_PITCH)
    teeth: int = field(metadata=_TEETH)
    ratio: Fraction = field(default=Fraction(1), metadata=_RATIO)

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def travel_per_turn(self) -> Fraction:
        """Pitch times teeth over ratio [mm]."""
        return self.pitch * self.teeth / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Direct:
    """A rotary joint on the motor's shaft or a gearbox: 360 degrees over ratio a turn."""

    kind: ClassVar[str] = "direct"
    moves: ClassVar[AxisKind | None] = AxisKind.ROTARY

    ratio: Fraction = field(default=Fraction(1), metadata=_RATIO)

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def travel_per_turn(self) -> Fraction:
        """360 over ratio [degree]."""
        return 360 / self.ratio


@dataclass(frozen=True, slots=True, kw_only=True)
class Travel:
    """Any transmission known only by the travel of one turn [mm or degree], as measured or as another file gave it."""

    kind: ClassVar[str] = "travel"
    moves: ClassVar[AxisKind | None] = None

    per_turn: Fraction = field(
        metadata=key(Exact("length", motion=True), "travel of the joint for one turn behind the gear", Bound.POSITIVE)
    )
    ratio: Fraction = field(default=Fraction(1), metadata=_RATIO)

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def travel_per_turn(self) -> Fraction:
        """Travel of one turn over ratio [mm or degree]."""
        return self.per_turn / self.ratio


TRANSMISSIONS: dict[str, type[Leadscrew | Belt | Rack | Direct | Travel]] = {
    cls.kind: cls for cls in (Leadscrew, Belt, Rack, Direct, Travel)
}
