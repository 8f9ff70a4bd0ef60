"""Servo motors as rows of a catalogue: what a machine file says of one.

In: numbers with their units.  Out: the equations' parameters, and what the motor may be asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

from trochia.machine.codecs import Quantity, Text, Whole
from trochia.machine.motors.dc import DcMotor
from trochia.machine.motors.pmsm import Pmsm
from trochia.machine.schema import Bound, check_bounds, key

_INERTIA = key(Quantity("inertia"), "of the rotor", Bound.POSITIVE)
_VISCOUS = key(Quantity("viscous friction"), "of the motor itself", Bound.NOT_NEGATIVE)
_FRICTION = key(Quantity("torque"), "of bearings and brushes, whatever the speed", Bound.NOT_NEGATIVE)
_CURRENT = key(Quantity("current"), "it may carry for ever", Bound.POSITIVE)
_PEAK = key(Quantity("current"), "it may carry for a moment", Bound.POSITIVE)
_SPEED = key(Quantity("rotation speed"), "it may turn at", Bound.POSITIVE)
_SOURCE = key(Text(), "where the numbers come from")


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueDc:
    """A brushed motor of permanent magnets."""

    kind: ClassVar[str] = "dc"

    resistance: float = field(metadata=key(Quantity("resistance"), "of the armature", Bound.POSITIVE))
    inductance: float = field(default=0.0, metadata=key(Quantity("inductance"), "of the armature", Bound.NOT_NEGATIVE))
    inertia: float = field(metadata=_INERTIA)
    torque_constant: float = field(metadata=key(Quantity("torque constant"), "Kt", Bound.POSITIVE))
    emf_constant: float | None = field(
        default=None, metadata=key(Quantity("emf constant"), "Kb; without it the same number as Kt", Bound.POSITIVE)
    )
    viscous: float = field(default=0.0, metadata=_VISCOUS)
    friction: float = field(default=0.0, metadata=_FRICTION)
    current: float | None = field(default=None, metadata=_CURRENT)
    peak_current: float | None = field(default=None, metadata=_PEAK)
    speed: float | None = field(default=None, metadata=_SPEED)
    source: str | None = field(default=None, metadata=_SOURCE)

    def __post_init__(self) -> None:
        check_bounds(self)

    def parameters(self) -> DcMotor:
        """Return what the equations need."""
        return DcMotor(
            resistance=self.resistance, inductance=self.inductance, inertia=self.inertia,
            torque_constant=self.torque_constant, emf_constant=self.emf_constant or self.torque_constant,
            viscous=self.viscous,
        )  # fmt: skip

    @property
    def greatest_speed(self) -> float:
        """What it may turn at [rad/s]; infinite where nothing is said."""
        return radians_a_second(self.speed)


@dataclass(frozen=True, slots=True, kw_only=True)
class CataloguePmsm:
    """A brushless motor of permanent magnets with a sine-wave amplifier; currents are peaks of a phase."""

    kind: ClassVar[str] = "pmsm"

    resistance: float = field(metadata=key(Quantity("resistance"), "of a phase to the star point", Bound.POSITIVE))
    inductance: float = field(
        metadata=key(Quantity("inductance"), "of a phase, Lq (Ld is taken as the same)", Bound.POSITIVE)
    )
    pole_pairs: int = field(metadata=key(Whole(), "pairs of poles", Bound.POSITIVE))
    inertia: float = field(metadata=_INERTIA)
    torque_constant: float = field(
        metadata=key(Quantity("torque constant"), "torque an ampere of peak phase current", Bound.POSITIVE)
    )
    viscous: float = field(default=0.0, metadata=_VISCOUS)
    friction: float = field(default=0.0, metadata=_FRICTION)
    current: float | None = field(default=None, metadata=_CURRENT)
    peak_current: float | None = field(default=None, metadata=_PEAK)
    speed: float | None = field(default=None, metadata=_SPEED)
    source: str | None = field(default=None, metadata=_SOURCE)

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def pmsm(self) -> Pmsm:
        """The motor in its own, turning frame."""
        return Pmsm(
            resistance=self.resistance, inductance_d=self.inductance, inductance_q=self.inductance,
            flux=self.torque_constant / (1.5 * self.pole_pairs), pole_pairs=self.pole_pairs, inertia=self.inertia,
            viscous=self.viscous,
        )  # fmt: skip

    def parameters(self) -> DcMotor:
        """Return the motor of direct current that it is while its field current is held at zero."""
        return self.pmsm.as_dc()

    @property
    def greatest_speed(self) -> float:
        """What it may turn at [rad/s]; infinite where nothing is said."""
        return radians_a_second(self.speed)


SERVO_MOTORS: dict[str, type[CatalogueDc | CataloguePmsm]] = {cls.kind: cls for cls in (CatalogueDc, CataloguePmsm)}


def radians_a_second(rpm: float | None) -> float:
    """Return a speed [rad/s] of one in rev/min; infinite for None."""
    return math.inf if rpm is None else rpm * math.tau / 60.0
