"""Joints: the motors behind the axes, with transmission, encoder and backlash.

The crossing from axis space to tick space: ``steps_per_unit`` and ``counts_per_unit`` are exact fractions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

    from trochia.machine.transmissions import Transmission


@dataclass(frozen=True, slots=True, kw_only=True)
class Stepper:
    """A stepper with its driver: full steps a turn, micro-steps a step."""

    full_steps: int = 200
    microsteps: int = 1
    model: str | None = None

    @property
    def steps_per_turn(self) -> int:
        """Pulses a turn."""
        return self.full_steps * self.microsteps


@dataclass(frozen=True, slots=True, kw_only=True)
class Servo:
    """A servo with its amplifier; the loop's parameters come with the servo rooms."""

    model: str | None = None


Motor = Stepper | Servo
MOTORS: dict[str, type[Motor]] = {"stepper": Stepper, "servo": Servo}


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """Counts a turn (after quadrature), on the motor's shaft or on the load (then counts a mm or degree)."""

    counts: Fraction
    on_load: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class PulseTiming:
    """What a driver's step and direction inputs ask: step high, step low, direction before and after a step [s]."""

    length: float = 1e-6
    space: float = 1e-6
    setup: float = 1e-6
    hold: float = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """One motor and what it drives.

    Attributes
    ----------
    backlash
        Lost motion on reversal [mm or degree].
    velocity, acceleration
        Limits of the joint itself, beside those of the axes [mm/s, mm/s²].
    pulse_rate
        Greatest step rate of its driver [1/s].
    """

    name: str
    motor: Motor
    transmission: Transmission
    encoder: Encoder | None = None
    backlash: float = 0.0
    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    pulse_rate: float | None = None
    pulses: PulseTiming = PulseTiming()

    @property
    def steps_per_unit(self) -> Fraction | None:
        """Step pulses a mm or degree, exactly; None for a servo."""
        if isinstance(self.motor, Stepper):
            return self.motor.steps_per_turn / self.transmission.travel_per_turn
        return None

    @property
    def counts_per_unit(self) -> Fraction | None:
        """Encoder counts a mm or degree, exactly; None without an encoder."""
        if self.encoder is None:
            return None
        if self.encoder.on_load:
            return self.encoder.counts
        return self.encoder.counts / self.transmission.travel_per_turn
