"""Axes: what a program moves, and how far and how fast it may."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from trochia.errors import ConfigError


class AxisKind(Enum):
    """Linear axes are in mm, rotary ones in degrees."""

    LINEAR = "linear"
    ROTARY = "rotary"


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One axis: travel [mm or degree], greatest velocity, acceleration and (if the machine gives one) jerk."""

    name: str
    kind: AxisKind
    minimum: float
    maximum: float
    velocity: float
    acceleration: float
    jerk: float | None = None

    def __post_init__(self) -> None:
        for field in ("velocity", "acceleration", "jerk"):
            value = getattr(self, field)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ConfigError(f"axes.{self.name}.{field} must be above zero, not {value!r}")
        if not self.minimum < self.maximum:
            raise ConfigError(f"axes.{self.name}.travel must rise, not {self.minimum!r} to {self.maximum!r}")


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLimits:
    """Caps on the vector along the path [mm/s, mm/s², mm/s³]; what is not given does not bind."""

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
