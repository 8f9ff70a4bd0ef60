"""The variable reluctance stepper at work: equations of any number of phases, and a run through its steps.

In: a motor's geometry and its electrical values, the phase that is on.  Out: torque, derivatives, the way of the rotor.

    v = R i + L di/dt + i w dL/dx        L(x) = L0 + L1 cos(N x - s 2 pi k/m)        k = 0 … m - 1
    T = ½ Σ i² dL/dx                     J dw/dt = T - B w - dry friction - load

Symbols: N rotor teeth, m phases, s +1 where the rotor follows the order of excitation and -1 where it turns against it
(fewer teeth than poles), L0 and L1 mean and half the difference of inductance in line and out of it.  The iron does not
saturate and the phases are not coupled (Acarnley).  The current's sign does not matter, so drivers are unipolar.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.motors.hybrid import FREE
from trochia.machine.motors.shaft import dry_friction

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors.reluctance import ReluctanceStepper
    from trochia.machine.motors.shaft import ShaftLoad

    Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReluctanceDrive:
    """A variable reluctance motor; a state is (currents of the phases [A] …, angle [rad], speed [rad/s]).

    Attributes
    ----------
    resistance
        Of a phase [ohm].
    aligned, unaligned
        Inductance of a phase with rotor teeth under its poles, and with slots [H].
    inertia, friction, viscous
        Of the rotor [kg·m²], [N·m], [N·m·s/rad].
    """

    geometry: ReluctanceStepper
    resistance: float
    aligned: float
    unaligned: float
    inertia: float
    friction: float = 0.0
    viscous: float = 0.0

    def __post_init__(self) -> None:
        for name in ("resistance", "unaligned", "inertia"):
            if not 0 < getattr(self, name) < math.inf:
                raise ConfigError(f"must be above zero, not {getattr(self, name):g}", key=name)
        if not self.unaligned < self.aligned < math.inf:
            raise ConfigError(
                f"must be above the inductance out of line, {self.unaligned:g} H, not {self.aligned:g} H: "
                "the difference makes the torque",
                key="aligned",
            )

    def _angles(self, theta: Array) -> Array:
        """Return N x less the phase's own angle (..., phases)."""
        phases = np.arange(self.geometry.phases)
        shift = self.geometry.direction * self.geometry.phase_shift * phases
        return self.geometry.teeth * np.asarray(theta)[..., None] - shift

    def inductance(self, theta: Array) -> Array:
        """Return the inductance of every phase (..., phases) [H]."""
        mean, half = (self.aligned + self.unaligned) / 2, (self.aligned - self.unaligned) / 2
        return mean + half * np.cos(self._angles(theta))

    def slope(self, theta: Array) -> Array:
        """Return dL/dx of every phase (..., phases) [H/rad]."""
        half = (self.aligned - self.unaligned) / 2
        return -half * self.geometry.teeth * np.sin(self._angles(theta))

    def torque(self, currents: Array, theta: Array) -> Array:
        """Return the torque on the rotor (...) [N·m] for currents (..., phases)."""
        return 0.5 * (currents**2 * self.slope(theta)).sum(axis=-1)

    def holding_torque(self, current: float) -> float:
        """Return the greatest torque of one phase [N·m]: N (L_aligned - L_unaligned) I²/4."""
        return self.geometry.teeth * (self.aligned - self.unaligned) * current * current / 4

    def derivative(self, state: Array, voltages: Array, load: ShaftLoad = FREE) -> Array:
        """Return d/dt of states (..., phases + 2) under phase voltages (..., phases)."""
        currents, theta, omega = state[..., :-2], state[..., -2], state[..., -1]
        induced = currents * omega[..., None] * self.slope(theta)
        electric = (voltages - self.resistance * currents - induced) / self.inductance(theta)
        drag = (self.viscous + load.viscous) * omega + dry_friction(self.friction + load.friction, omega)
        net = self.torque(currents, theta) - drag - load.constant
        return np.concatenate([electric, np.stack([omega, net / (self.inertia + load.inertia)], axis=-1)], axis=-1)

    def run(
        self, phase: Array, voltage: float, *, step: float, load: ShaftLoad = FREE, state: Array | None = None
    ) -> Array:
        """Return the states after each time step (steps, phases + 2), Runge-Kutta of fourth order.

        Parameters
        ----------
        phase
            Number of the phase that is on in each step (steps,), below zero none; a phase that is off is driven with
            minus the voltage until its current is gone, as by diodes to the supply.
        state
            To begin with; at rest in line with phase 0 where None.
        """
        phases = self.geometry.phases
        y = np.zeros(phases + 2) if state is None else np.array(state, np.float64)
        out = np.empty((len(phase), phases + 2))
        for n, on in enumerate(np.asarray(phase).astype(int).tolist()):
            volts = np.where(y[:phases] > 0, -voltage, 0.0)
            if on >= 0:
                volts[on % phases] = voltage
            k1 = self.derivative(y, volts, load)
            k2 = self.derivative(y + step / 2 * k1, volts, load)
            k3 = self.derivative(y + step / 2 * k2, volts, load)
            k4 = self.derivative(y + step * k3, volts, load)
            y = y + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            y[:phases] = np.maximum(y[:phases], 0.0)
            out[n] = y
        return out
