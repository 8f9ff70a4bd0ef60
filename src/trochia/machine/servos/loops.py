"""Servo loops as data: what a machine file says of how a joint's loop is closed.

In: gains in physical units of the motor's shaft, or the integers of a real controller.  Out: frozen rows; the room
``servo`` makes loops of them.  A command is in volts, the amplifier's.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from trochia.errors import ConfigError
from trochia.machine.codecs import Flag, Number, Quantity, Whole
from trochia.machine.schema import Bound, Record, check_bounds, key

_PERIOD = key(Quantity("time"), "of the loop; without it the machine's servo_period", Bound.POSITIVE)
_DEAD_BAND = key(Quantity("length", motion=True), "position errors that are none", Bound.NOT_NEGATIVE)
_LOW_PASS = key(Quantity("frequency"), "of second order, on the command", Bound.POSITIVE)
_LIMIT = key(Quantity("voltage"), "of the command; without it the amplifier's", Bound.POSITIVE)
_MOST_16 = (1 << 16) - 1


def _forward(of: str) -> dict[str, object]:
    return {**key(Number(), f"part of what {of} asks of the nominal plant that is fed forward", Bound.NOT_NEGATIVE)}


@dataclass(frozen=True, slots=True, kw_only=True)
class NotchData:
    """A notch on the command."""

    frequency: float = field(metadata=key(Quantity("frequency"), "that it takes out", Bound.POSITIVE))
    width: float = field(default=0.5, metadata=key(Number(), "its width over its frequency", Bound.POSITIVE))
    depth: float = field(default=0.0, metadata=key(Number(), "what is left in its middle", Bound.NOT_NEGATIVE))

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeLoop:
    """Position, then speed; the amplifier closes the current."""

    kind: ClassVar[str] = "cascade"

    position_gain: float = field(metadata=key(Quantity("rate"), "speed for a position error", Bound.POSITIVE))
    speed_gain: float = field(metadata=key(Quantity("emf constant"), "command for a speed error", Bound.POSITIVE))
    speed_integral: float = field(
        default=0.0, metadata=key(Quantity("rate"), "of the speed error, over speed_gain", Bound.NOT_NEGATIVE)
    )
    averaged: int = field(
        default=1, metadata=key(Whole(), "periods over which speed is measured, at most 8", Bound.POSITIVE)
    )
    velocity_forward: float = field(default=0.0, metadata=_forward("velocity"))
    acceleration_forward: float = field(default=0.0, metadata=_forward("acceleration"))
    friction_forward: float = field(default=0.0, metadata=_forward("dry friction"))
    dead_band: float = field(default=0.0, metadata=_DEAD_BAND)
    notch: NotchData | None = field(default=None, metadata=key(Record(NotchData), "on the command"))
    low_pass: float | None = field(default=None, metadata=_LOW_PASS)
    limit: float | None = field(default=None, metadata=_LIMIT)
    period: float | None = field(default=None, metadata=_PERIOD)

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class PidLoop:
    """One PID of the position; its derivative is that of the position measured."""

    kind: ClassVar[str] = "pid"

    kp: float = field(metadata=key(Quantity("position gain"), "command for a position error", Bound.POSITIVE))
    ki: float = field(default=0.0, metadata=key(Quantity("integral gain"), "and for its integral", Bound.NOT_NEGATIVE))
    kd: float = field(default=0.0, metadata=key(Quantity("emf constant"), "against the speed", Bound.NOT_NEGATIVE))
    filter: float | None = field(
        default=None, metadata=key(Quantity("rate"), "corner of the derivative's filter, N", Bound.POSITIVE)
    )
    velocity_forward: float = field(default=0.0, metadata=_forward("velocity"))
    acceleration_forward: float = field(default=0.0, metadata=_forward("acceleration"))
    friction_forward: float = field(default=0.0, metadata=_forward("dry friction"))
    dead_band: float = field(default=0.0, metadata=_DEAD_BAND)
    notch: NotchData | None = field(default=None, metadata=key(Record(NotchData), "on the command"))
    low_pass: float | None = field(default=None, metadata=_LOW_PASS)
    limit: float | None = field(default=None, metadata=_LIMIT)
    period: float | None = field(default=None, metadata=_PERIOD)

    def __post_init__(self) -> None:
        check_bounds(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class PmacLoop:
    """The servo law of a PMAC card, by its I-variables (the names are their numbers), in whole numbers."""

    kind: ClassVar[str] = "pmac"

    i30: int = field(metadata=key(Whole(), "proportional gain"))
    i31: int = field(default=0, metadata=key(Whole(), "derivative gain"))
    i32: int = field(default=0, metadata=key(Whole(), "velocity feed-forward"))
    i33: int = field(default=0, metadata=key(Whole(), "integral gain", Bound.NOT_NEGATIVE))
    i34: int = field(default=1, metadata=key(Whole(), "1: it integrates while no velocity is commanded"))
    i35: int = field(default=0, metadata=key(Whole(), "acceleration feed-forward"))
    i08: int = field(default=96, metadata=key(Whole(), "position scale", Bound.POSITIVE))
    i09: int = field(default=96, metadata=key(Whole(), "velocity scale", Bound.NOT_NEGATIVE))
    i29: int = field(default=0, metadata=key(Whole(), "offset of the output [bits]"))
    i63: int = field(default=4194304, metadata=key(Whole(), "limit of the integral [counts · cycles]", Bound.POSITIVE))
    i64: int = field(default=0, metadata=key(Whole(), "gain inside the dead band, in 16ths"))
    i65: int = field(default=0, metadata=key(Whole(), "dead band [1/16 count]", Bound.NOT_NEGATIVE))
    i67: int = field(default=4194304, metadata=key(Whole(), "limit of the error [1/16 count]", Bound.POSITIVE))
    i69: int = field(default=20480, metadata=key(Whole(), "limit of the output [bits], 32768 are 10 V", Bound.POSITIVE))
    period: float | None = field(default=None, metadata=_PERIOD)

    def __post_init__(self) -> None:
        check_bounds(self)
        for name, most in (("i30", 1 << 23), ("i31", 1 << 23), ("i32", 1 << 23), ("i33", 1 << 23), ("i35", 1 << 23),
                           ("i08", 1 << 8), ("i09", 1 << 8), ("i63", 1 << 23), ("i65", 1 << 15), ("i67", 1 << 23),
                           ("i64", 1 << 15), ("i29", 1 << 15), ("i69", 1 << 15)):  # fmt: skip
            if abs(getattr(self, name)) > most:
                raise ConfigError(f"must be within ±{most}, not {getattr(self, name)}", key=name)
        if self.i34 not in (0, 1):
            raise ConfigError(f"must be 0 or 1, not {self.i34}", key="i34")


@dataclass(frozen=True, slots=True, kw_only=True)
class ThirtySecondsLoop:
    """The integer PID of a small chip: gains in 32nds, errors in counts, output in steps of its PWM."""

    kind: ClassVar[str] = "32nds"

    p: int = field(metadata=key(Whole(), "32 Kp", Bound.NOT_NEGATIVE))
    i: int = field(default=0, metadata=key(Whole(), "32 Ki · period", Bound.NOT_NEGATIVE))
    d: int = field(default=0, metadata=key(Whole(), "32 Kd / period", Bound.NOT_NEGATIVE))
    most: int = field(default=1023, metadata=key(Whole(), "output of the greatest command", Bound.POSITIVE))
    mended: bool = field(
        default=True, metadata=key(Flag(), "the derivative saturates and the motor is driven both ways; else as it was "
                                   "built")
    )  # fmt: skip
    period: float | None = field(default=None, metadata=_PERIOD)

    def __post_init__(self) -> None:
        check_bounds(self)
        for name in ("p", "i", "d"):
            if getattr(self, name) > _MOST_16:
                raise ConfigError(f"must fit 16 bits, not {getattr(self, name)}", key=name)
        if self.most >= 1 << 15:
            raise ConfigError(f"must be below 32768, not {self.most}", key="most")


ServoLoop = CascadeLoop | PidLoop | PmacLoop | ThirtySecondsLoop
LOOPS: dict[str, type[ServoLoop]] = {cls.kind: cls for cls in (CascadeLoop, PidLoop, PmacLoop, ThirtySecondsLoop)}
