"""Voltage drives: the supply lies across the phase, and only resistance and back-EMF hold the current.

In a file: ``driver = { kind = "h-bridge", supply = "12 V" }``.  Out: what a phase sees.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity, Text
from trochia.machine.drivers.bridge import Bridge, check_dead_time
from trochia.machine.drivers.chip import Chip, check_supply
from trochia.machine.schema import Bound, check_bounds, key

IDLE = ("hold", "short", "open")  #: what becomes of the phases when a motor is released
SUPPLY = key(Quantity("voltage"), "of the motor's supply", Bound.POSITIVE)
EXCITATION = key(Text(), "how the phases are switched: one-phase, two-phase, half-step, microstep-N; by microsteps if "
                 "not given")  # fmt: skip
CURRENT_LIMIT = key(Quantity("current"), "continuous, of a phase: the driver's own limit", Bound.POSITIVE)
POWER_LIMIT = key(Quantity("power"), "heat it gets rid of, all phases together", Bound.POSITIVE)
WHEN_RELEASED = key(Text(IDLE), "what becomes of the phases when the motor is released")


@dataclass(frozen=True, slots=True, kw_only=True)
class HBridge:
    """A bridge for each phase, as an L293D; its saturation drop is taken off the supply, and is what heats it."""

    kind: ClassVar[str] = "h-bridge"
    chip: ClassVar[Chip | None] = None

    supply: float = field(metadata=SUPPLY)
    drop: float = field(
        default=2.6,  # an L293D: the sum of L293D_DROPS
        metadata=key(Quantity("voltage"), "across the two transistors that conduct", Bound.NOT_NEGATIVE),
    )
    excitation: str | None = field(default=None, metadata=EXCITATION)
    released: str = field(default="short", metadata=WHEN_RELEASED)
    current_limit: float | None = field(default=None, metadata=CURRENT_LIMIT)
    power_limit: float | None = field(default=None, metadata=POWER_LIMIT)
    turn_on: float = field(
        default=0.0, metadata=key(Quantity("time"), "until a transistor conducts", Bound.NOT_NEGATIVE)
    )
    turn_off: float = field(
        default=0.0, metadata=key(Quantity("time"), "until a transistor has stopped conducting", Bound.NOT_NEGATIVE)
    )
    dead_time: float = field(
        default=0.0, metadata=key(Quantity("time"), "pause between two transistors of a leg", Bound.NOT_NEGATIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self)
        check_supply(self.chip, self.kind, self.supply)
        if self.drop >= self.supply:
            raise ConfigError(f"must be below the supply of {self.supply:g} V, not {self.drop:g} V", key="drop")
        check_dead_time(Bridge(turn_on=self.turn_on, turn_off=self.turn_off, dead_time=self.dead_time))

    @property
    def phase_voltage(self) -> float:
        """Across a phase at level 1 [V]."""
        return self.supply - self.drop

    @property
    def resistance(self) -> float:
        """What it adds to a phase [ohm]."""
        return 0.0

    @property
    def current(self) -> float | None:
        """What it holds the current of a phase to [A]: nothing does."""
        return None

    def loss(self, rms: float, mean: float) -> float:
        """Return its heat for a phase that carries a current, effective and mean magnitude [A], in W."""
        del rms
        return self.drop * mean


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesResistor:
    """L/R drive: a higher supply and a resistor before each phase make the current rise L/(R + R_series) fast."""

    kind: ClassVar[str] = "l/r"
    chip: ClassVar[Chip | None] = None

    supply: float = field(metadata=SUPPLY)
    series: float = field(metadata=key(Quantity("resistance"), "of the resistor before a phase", Bound.POSITIVE))
    drop: float = field(
        default=0.0, metadata=key(Quantity("voltage"), "across the transistors that conduct", Bound.NOT_NEGATIVE)
    )
    excitation: str | None = field(default=None, metadata=EXCITATION)
    released: str = field(default="open", metadata=WHEN_RELEASED)
    current_limit: float | None = field(default=None, metadata=CURRENT_LIMIT)
    power_limit: float | None = field(
        default=None, metadata=key(Quantity("power"), "of the resistors, all phases together", Bound.POSITIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.drop >= self.supply:
            raise ConfigError(f"must be below the supply of {self.supply:g} V, not {self.drop:g} V", key="drop")

    @property
    def phase_voltage(self) -> float:
        """Across a phase and its resistor at level 1 [V]."""
        return self.supply - self.drop

    @property
    def resistance(self) -> float:
        """What it adds to a phase [ohm]."""
        return self.series

    @property
    def current(self) -> float | None:
        """What it holds the current of a phase to [A]: nothing does."""
        return None

    def loss(self, rms: float, mean: float) -> float:
        """Return its heat for a phase that carries a current, effective and mean magnitude [A], in W."""
        return self.series * rms * rms + self.drop * mean
