"""The brushed DC motor: parameters and equations.

    L di/dt = v - R i - Kb w          J dw/dt = Kt i - b w - load

In SI units Kt [N·m/A] and Kb [V·s/rad] are the same number for an ideal machine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity
from trochia.machine.schema import Bound, check_bounds, key

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class DcMotor:
    """Parameters of a permanent-magnet DC motor; a state is (current [A], speed [rad/s]).

    Attributes
    ----------
    torque_constant, emf_constant
        Kt [N·m/A], Kb [V·s/rad].
    viscous
        b [N·m·s/rad].
    """

    kind: ClassVar[str] = "dc"

    resistance: float = field(metadata=key(Quantity("resistance"), "of the armature", Bound.POSITIVE))
    inductance: float = field(metadata=key(Quantity("inductance"), "of the armature", Bound.NOT_NEGATIVE))
    inertia: float = field(metadata=key(Quantity("inertia"), "of the rotor", Bound.POSITIVE))
    torque_constant: float
    emf_constant: float
    viscous: float = 0.0

    def __post_init__(self) -> None:
        check_bounds(self)
        for name in ("torque_constant", "emf_constant"):
            if not getattr(self, name) > 0.0:
                raise ConfigError(f"must be above zero, not {getattr(self, name)!r}", key=name)

    @classmethod
    def from_catalogue(
        cls,
        *,
        voltage: float,
        resistance: float,
        inductance: float,
        torque_constant: float,
        inertia: float,
        no_load_current: float,
    ) -> Self:
        """Return the motor of a catalogue's row: its no-load current at its voltage tells the friction b.

        Raises
        ------
        ConfigError
            When the no-load current takes up the whole voltage.
        """
        speed = (voltage - resistance * no_load_current) / torque_constant
        if not speed > 0.0:
            raise ConfigError(
                f"{no_load_current:g} A through {resistance:g} ohm take more than the {voltage:g} V there are",
                key="no_load_current",
            )
        return cls(
            resistance=resistance, inductance=inductance, inertia=inertia, torque_constant=torque_constant,
            emf_constant=torque_constant, viscous=torque_constant * no_load_current / speed,
        )  # fmt: skip

    def derivative(self, state: NDArray[np.float64], voltage: float, load: float = 0.0) -> NDArray[np.float64]:
        """Return d/dt of states (..., 2) under a voltage [V] and a load torque [N·m]; needs inductance."""
        current, speed = state[..., 0], state[..., 1]
        return np.stack([
            (voltage - self.resistance * current - self.emf_constant * speed) / self.inductance,
            (self.torque_constant * current - self.viscous * speed - load) / self.inertia,
        ], axis=-1)  # fmt: skip

    def characteristic(self, *, inertia: float = 0.0) -> tuple[float, float, float]:
        """Return the coefficients of s², s and 1 of the polynomial whose roots are the poles, with a load's inertia."""
        j = self.inertia + inertia
        return (
            self.inductance * j,
            self.inductance * self.viscous + self.resistance * j,
            self.resistance * self.viscous + self.torque_constant * self.emf_constant,
        )

    def poles(self, *, inertia: float = 0.0) -> NDArray[np.complex128]:
        """Return the poles of speed by voltage [1/s], slowest first."""
        roots = np.roots(np.trim_zeros(self.characteristic(inertia=inertia), "f")).astype(np.complex128)
        return roots[np.argsort(-roots.real)]

    def gain(self) -> float:
        """Return speed per volt at rest of everything else [rad/s/V]."""
        return self.torque_constant / self.characteristic()[2]

    def no_load_speed(self, voltage: float) -> float:
        """Return the speed at which the voltage is used up [rad/s]."""
        return self.gain() * voltage

    def stall_torque(self, voltage: float) -> float:
        """Return the torque at rest [N·m]."""
        return self.torque_constant * voltage / self.resistance

    @property
    def time_constants(self) -> tuple[float, float]:
        """Electrical L/R and mechanical R J / Kt Kb time constants [s]."""
        mechanical = self.resistance * self.inertia / (self.torque_constant * self.emf_constant)
        return self.inductance / self.resistance, mechanical

    def rating(self, current: float) -> float:
        """Return the heat in the winding at a current [W]."""
        return self.resistance * current * current if math.isfinite(current) else math.inf
