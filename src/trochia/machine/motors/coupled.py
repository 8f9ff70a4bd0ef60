"""A load behind an elastic coupling: belt, shaft or bellows between rotor and load.

In: states (i_a [A], i_b [A], angle [rad], speed [rad/s], angle and speed of the load).  Out: their derivatives.

    C = k (x - y) + c (w - u)        J dw/dt = T - B w - dry friction - C        J_l du/dt = C - load's drag - load

Symbols: x, w of the rotor; y, u of the load; k stiffness, c damping, C what the coupling passes on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.motors.shaft import dry_friction

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors.hybrid import HybridStepper
    from trochia.machine.motors.shaft import ShaftLoad

    Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    """Stiffness [N·m/rad] and damping [N·m·s/rad] between rotor and load."""

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.stiffness < math.inf:
            raise ConfigError(f"must be above zero, not {self.stiffness:g} N·m/rad", key="stiffness")
        if not 0 <= self.damping < math.inf:
            raise ConfigError(f"must be zero or more, not {self.damping:g} N·m·s/rad", key="damping")

    def resonance(self, motor: HybridStepper, load: ShaftLoad) -> float:
        """Return the frequency at which rotor and load swing against each other [Hz]."""
        return math.sqrt(self.stiffness * (1 / motor.inertia + 1 / load.inertia)) / math.tau


def belt_stiffness(area_modulus: float, spans: tuple[float, float], radius: float) -> float:
    """Return the stiffness of a closed belt at its pulley [N·m/rad]: E A (1/a + 1/b) r².

    Parameters
    ----------
    area_modulus
        E A of the belt: force that would stretch it to twice its length [N].
    spans
        Lengths of belt on the two sides of the carriage [m].
    radius
        Of the pulley [m].
    """
    return area_modulus * sum(1 / span for span in spans) * radius * radius


def coupled_derivative(
    motor: HybridStepper, coupling: Coupling, load: ShaftLoad, state: Array, voltages: Array
) -> Array:
    """Return d/dt of states (..., 6) under phase voltages (..., 2); the load's inertia is behind the coupling."""
    currents, theta, omega = state[..., :2], state[..., 2], state[..., 3]
    there, speed = state[..., 4], state[..., 5]
    across = coupling.stiffness * (theta - there) + coupling.damping * (omega - speed)
    electric = (voltages - motor.resistance * currents - motor.back_emf(theta, omega)) / motor.inductance
    own = motor.torque(currents, theta) - motor.viscous * omega - dry_friction(motor.friction, omega) - across
    behind = across - load.viscous * speed - dry_friction(load.friction, speed) - load.constant
    mechanics = np.stack([omega, own / motor.inertia, speed, behind / load.inertia], axis=-1)
    return np.concatenate([electric, mechanics], axis=-1)
