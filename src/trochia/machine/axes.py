"""Axes: what a program moves, and how far and how fast it may."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from trochia.errors import ConfigError
from trochia.machine.acceleration import AccelerationCurve, CurveOfAcceleration
from trochia.machine.codecs import Quantity, Text
from trochia.machine.homing import Homing, LimitSwitch
from trochia.machine.resonance import Resonance
from trochia.machine.schema import Bound, Record, check_bounds, key

LETTERS = "XYZABCUVW"  #: in the order of every machine's axes and of a program's columns


class AxisKind(Enum):
    """Linear axes are in mm, rotary ones in degrees."""

    LINEAR = "linear"
    ROTARY = "rotary"


def check_letter(name: str) -> None:
    """Refuse a name that is no axis letter, with a ConfigError."""
    if name not in tuple(LETTERS):
        raise ConfigError(f"an axis is one of the letters {' '.join(LETTERS)}, not {name!r}", key=f"axes.{name}")


_POSITION = Quantity("length", motion=True)
_VELOCITY = Quantity("velocity", motion=True)
_ACCELERATION = Quantity("acceleration", motion=True)
_JERK = Quantity("jerk", motion=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One axis: travel [mm or degree], greatest velocity, acceleration and (if the machine gives one) jerk.

    Where acceleration falls with speed, the profile torque follows ``acceleration_curve``; the others keep its least.
    """

    name: str
    kind: AxisKind = field(
        metadata=key(
            Text(("linear", "rotary"), AxisKind), "linear (mm) or rotary (degrees); by the letter if not given"
        )
    )
    minimum: float = field(metadata=key(_POSITION, "lower end of travel, in machine coordinates"))
    maximum: float = field(metadata=key(_POSITION, "upper end of travel"))
    velocity: float = field(metadata=key(_VELOCITY, "greatest velocity", Bound.POSITIVE))
    acceleration: float = field(metadata=key(_ACCELERATION, "greatest acceleration", Bound.POSITIVE))
    jerk: float | None = field(
        default=None, metadata=key(_JERK, "greatest jerk; none: acceleration may jump", Bound.POSITIVE)
    )
    acceleration_curve: AccelerationCurve | None = field(
        default=None,
        metadata=key(CurveOfAcceleration(), "greatest acceleration by speed, falling; the profile torque follows it"),
    )
    resonance: Resonance | None = field(
        default=None, metadata=key(Record(Resonance), "how the axis swings, and the shaper that cancels it")
    )
    home: Homing | None = field(default=None, metadata=key(Record(Homing), "how the axis finds its reference"))
    limit_minus: LimitSwitch | None = field(
        default=None, metadata=key(Record(LimitSwitch), "the switch at its lower end")
    )
    limit_plus: LimitSwitch | None = field(
        default=None, metadata=key(Record(LimitSwitch), "the switch at its upper end")
    )

    def __post_init__(self) -> None:
        check_letter(self.name)
        check_bounds(self, rotary=self.rotary, path=f"axes.{self.name}")
        if not self.minimum < self.maximum:
            low, high = (_POSITION.write(value, rotary=self.rotary) for value in (self.minimum, self.maximum))
            raise ConfigError(f"must lie above minimum ({low}), not at {high}", key=f"axes.{self.name}.maximum")

    @property
    def rotary(self) -> bool:
        """Whether its unit is the degree."""
        return self.kind is AxisKind.ROTARY

    @property
    def unit(self) -> str:
        """Unit of its position: mm or deg."""
        return "deg" if self.rotary else "mm"


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLimits:
    """Caps on the vector along the path [mm/s, mm/s², mm/s³]; what is not given does not bind."""

    velocity: float | None = field(
        default=None, metadata=key(Quantity("velocity"), "greatest speed along the path", Bound.POSITIVE)
    )
    acceleration: float | None = field(
        default=None, metadata=key(Quantity("acceleration"), "greatest acceleration of the vector", Bound.POSITIVE)
    )
    jerk: float | None = field(
        default=None, metadata=key(Quantity("jerk"), "greatest jerk of the vector", Bound.POSITIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self, path="path")
