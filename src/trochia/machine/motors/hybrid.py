"""The two-phase hybrid (or permanent magnet) stepper: parameters and equations.

In: currents [A] or voltages [V] of the phases, angle [rad] and speed [rad/s] of the shaft.  Out: back-EMF, torque, and
the derivative of the state; arrays of any leading shape.

    L di/dt = v - R i - e        e_a = -K w sin(p x)        e_b = K w cos(p x)
    T = -K i_a sin(p x) + K i_b cos(p x) - D sin(4 p x)
    (J + J_load) dw/dt = T - B w - dry friction - load

Symbols: x angle, w speed, p rotor teeth (pole pairs), K torque constant of one phase, D detent torque, B viscous
friction.  This is the usual form with sinusoidal flux, constant inductance and no coupling between the phases
(Acarnley, *Stepping Motors*; Kenjo and Sugawara).  Current in phase A alone holds the rotor at p x = 0, in B alone at
90 degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from trochia.machine.codecs import Quantity, Whole
from trochia.machine.motors.shaft import ShaftLoad, dry_friction
from trochia.machine.schema import Bound, check_bounds, key

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FREE = ShaftLoad()  #: nothing on the shaft


@dataclass(frozen=True, slots=True, kw_only=True)
class HybridStepper:
    """Parameters of a two-phase stepper; a state is (i_a [A], i_b [A], angle [rad], speed [rad/s])."""

    kind: ClassVar[str] = "hybrid"

    teeth: int = field(metadata=key(Whole(), "teeth of a rotor disc, or pole pairs of a magnet", Bound.POSITIVE))
    resistance: float = field(metadata=key(Quantity("resistance"), "of a phase", Bound.POSITIVE))
    inductance: float = field(metadata=key(Quantity("inductance"), "of a phase", Bound.POSITIVE))
    current: float = field(metadata=key(Quantity("current"), "rated, of a phase", Bound.POSITIVE))
    inertia: float = field(metadata=key(Quantity("inertia"), "of the rotor", Bound.POSITIVE))
    torque_constant: float  #: of one phase [N·m/A], which is also its back-EMF constant [V·s/rad]
    detent: float = field(default=0.0, metadata=key(Quantity("torque"), "without current", Bound.NOT_NEGATIVE))
    friction: float = field(default=0.0, metadata=key(Quantity("torque"), "of the bearings", Bound.NOT_NEGATIVE))
    viscous: float = 0.0  #: friction that grows with speed [N·m·s/rad]

    def __post_init__(self) -> None:
        check_bounds(self)

    @property
    def full_steps(self) -> int:
        """Full steps a turn: a step is a quarter of a tooth pitch."""
        return 4 * self.teeth

    @property
    def step_angle(self) -> float:
        """Angle of a full step [rad]."""
        return math.tau / self.full_steps

    @property
    def time_constant(self) -> float:
        """Electrical time constant L/R [s]."""
        return self.inductance / self.resistance

    def speed(self, full_steps_s: float) -> float:
        """Return the speed of the shaft [rad/s] at a rate of full steps [1/s]."""
        return full_steps_s * self.step_angle

    def back_emf(self, theta: Array, omega: Array) -> Array:
        """Return the voltages that turning induces in the phases (..., 2) [V]."""
        angle = self.teeth * theta
        return self.torque_constant * np.stack([-omega * np.sin(angle), omega * np.cos(angle)], axis=-1)

    def detent_torque(self, theta: Array) -> Array:
        """Return the torque without current (...) [N·m]: four periods a tooth, at rest where one phase holds."""
        return -self.detent * np.sin(4 * self.teeth * theta)

    def torque(self, currents: Array, theta: Array) -> Array:
        """Return the torque on the rotor (...) [N·m] for currents (..., 2), detent included."""
        angle = self.teeth * theta
        magnetic = self.torque_constant * (currents[..., 1] * np.cos(angle) - currents[..., 0] * np.sin(angle))
        return magnetic + self.detent_torque(theta)

    def derivative(self, state: Array, voltages: Array, load: ShaftLoad = FREE) -> Array:
        """Return d/dt of states (..., 4) under phase voltages (..., 2)."""
        currents, theta, omega = state[..., :2], state[..., 2], state[..., 3]
        electric = (voltages - self.resistance * currents - self.back_emf(theta, omega)) / self.inductance
        drag = (self.viscous + load.viscous) * omega + dry_friction(self.friction + load.friction, omega)
        net = self.torque(currents, theta) - drag - load.constant
        return np.concatenate([electric, np.stack([omega, net / (self.inertia + load.inertia)], axis=-1)], axis=-1)

    def impedance(self, omega: Array) -> NDArray[np.complexfloating]:
        """Return the impedance of a phase [ohm] at the electrical frequency p·omega of a shaft speed [rad/s]."""
        return self.resistance + 1j * self.teeth * omega * self.inductance

    def lost_steps(
        self, field_angle: Array, theta: Array, omega: Array, resistance: float | None = None
    ) -> NDArray[np.int64]:
        """Return the full steps the rotor has lost against the field: multiples of four, below zero where it ran ahead.

        Parameters
        ----------
        field_angle
            Electrical angle of the phase voltages, counted on over whole turns [rad].
        theta, omega
            Of the shaft.
        resistance
            What a driver that holds the current to I has in place of R: V/I [ohm].

        Notes
        -----
        Stable points are a turn of the field apart, four full steps.  The one the rotor belongs to is the nearest, once
        the lag of the currents behind the voltages, atan(p·omega·L/R), is taken off the load angle.
        """
        lag = np.arctan(self.teeth * omega * self.inductance / (resistance or self.resistance))
        return 4 * np.rint((field_angle - self.teeth * theta - lag) / math.tau).astype(np.int64)
