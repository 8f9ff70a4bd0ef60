"""Driver chips by name: what a maker finds printed on the board is a kind of driver of its own.

In a file: ``driver = { kind = "A4988", supply = "24 V", current = "1.2 A" }``.  Out: a chopper or bridge with the
chip's own figures, which any key overrides; a supply, a current or microsteps the chip has not are refused.

A chip is one class here: the figures that differ from the kind it is built on, where they were read, and whether
someone has read that again for the row.  Figures are typical ones.  A new chip is one more class, named
in ``CHIPS``.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any, ClassVar

from trochia.machine.drivers.chip import Chip
from trochia.machine.drivers.chopper import Chopper
from trochia.machine.drivers.voltage import HBridge

_HEAT = "what a board carries without a heat sink is less: set current_limit to it"


def _own(base: type[Any], name: str, default: float | str) -> Any:  # noqa: ANN401 - as dataclasses.field
    """Return the field of the base with another default."""
    of_base = next(of for of in dataclasses.fields(base) if of.name == name)
    return field(default=default, metadata=of_base.metadata)


@dataclass(frozen=True, slots=True, kw_only=True)
class A4988(Chopper):
    """Step/dir driver of Allegro, to 16 microsteps."""

    kind: ClassVar[str] = "A4988"
    chip: ClassVar[Chip | None] = Chip(
        supply=(8.0, 35.0), microsteps=(1, 2, 4, 8, 16),
        source="A4988 datasheet, Allegro: 8 to 35 V, 2 A, 320 mohm a transistor, 30 us off; sense resistor 68 mohm",
        note=f"blanking and the fast part of mixed decay are usual values, not read; {_HEAT} (about 1 A)",
    )  # fmt: skip

    off_time: float = _own(Chopper, "off_time", 30e-6)
    mixed: float = _own(Chopper, "mixed", 0.31)
    on_resistance: float = _own(Chopper, "on_resistance", 0.71)
    current_limit: float | None = _own(Chopper, "current_limit", 2.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class DRV8825(Chopper):
    """Step/dir driver of Texas Instruments, to 32 microsteps."""

    kind: ClassVar[str] = "DRV8825"
    chip: ClassVar[Chip | None] = Chip(
        supply=(8.2, 45.0), microsteps=(1, 2, 4, 8, 16, 32),
        source="DRV8825 datasheet, Texas Instruments: 8.2 to 45 V, 2.5 A, 1/32 step, mixed decay",
        note="it chops at a fixed frequency, taken here as a fixed off time; off time, blanking, decay and resistance "
             f"are usual values, not read; {_HEAT} (about 1.5 A)",
    )  # fmt: skip

    off_time: float = _own(Chopper, "off_time", 20e-6)
    blanking: float = _own(Chopper, "blanking", 3.75e-6)
    mixed: float = _own(Chopper, "mixed", 0.75)
    current_limit: float | None = _own(Chopper, "current_limit", 2.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class TMC2209(Chopper):
    """Step/dir driver of Trinamic, in SpreadCycle; to 256 microsteps."""

    kind: ClassVar[str] = "TMC2209"
    chip: ClassVar[Chip | None] = Chip(
        supply=(4.75, 29.0), microsteps=(1, 2, 4, 8, 16, 32, 64, 128, 256),
        source="TMC2209 datasheet, Trinamic, rev. 1.03: 4.75 to 29 V, 2.8 A peak, 170 mohm a transistor, TOFF = 3: two "
               "slow decays of 108 clocks of 12 MHz, blanking 16 to 40 clocks",
        note="SpreadCycle's hysteresis is taken as a fixed off time, the fast part is a guess; StealthChop, which sets "
             "voltages, is not modelled; standstill current reduction, where a board has it, is hold_current = 0.53",
    )  # fmt: skip

    off_time: float = _own(Chopper, "off_time", 20e-6)
    blanking: float = _own(Chopper, "blanking", 2e-6)
    mixed: float = _own(Chopper, "mixed", 0.1)
    on_resistance: float = _own(Chopper, "on_resistance", 0.45)
    current_limit: float | None = _own(Chopper, "current_limit", 2.8)


@dataclass(frozen=True, slots=True, kw_only=True)
class L293D(HBridge):
    """Double bridge of the motor shield, with its saturation drop and its diodes."""

    kind: ClassVar[str] = "L293D"
    chip: ClassVar[Chip | None] = Chip(
        supply=(4.5, 36.0), microsteps=(1, 2, 16),
        source="L293D datasheet, STMicroelectronics: to 36 V, 0.6 A, saturation 1.4 and 1.2 V, on in 750 ns, "
               "off in 200 ns",
        checked=True,
        note="its enables are switched by PWM for microsteps; 1.2 A for a moment",
        circular=False,
    )  # fmt: skip

    turn_on: float = _own(HBridge, "turn_on", 750e-9)
    turn_off: float = _own(HBridge, "turn_off", 200e-9)
    current_limit: float | None = _own(HBridge, "current_limit", 0.6)


CHIPS: dict[str, type[Chopper | HBridge]] = {cls.kind: cls for cls in (A4988, DRV8825, TMC2209, L293D)}
