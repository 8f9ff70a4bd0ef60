"""The variable reluctance stepper at work: equations of any number of phases, and a run through its steps.

In: a motor's geometry and its electrical values, the phases that are on.  Out: torque, derivatives, the way of the
rotor, closed forms of what it holds and how it swings.

    v = R i + L di/dt + i w dL/dx        L(x) = L0 + L1 cos(N x - s 2 pi k/m)        k = 0 … m - 1
    T = ½ Σ i² dL/dx                     J dw/dt = T - B w - dry friction - load

Symbols: N rotor teeth, m phases, s +1 where the rotor follows the order of excitation and -1 where it turns against it
(fewer teeth than poles), L0 and L1 mean and half the difference of inductance in line and out of it.  The iron does not
saturate and the phases are not coupled (Acarnley).  The current's sign does not matter, so switches are unipolar: one
transistor a phase, and a diode that leads the current on when it opens.  A current therefore never falls below zero.

``core/host/reluctance.c`` runs the same equations; ``backends/reluctance_twin.py`` takes step pulses.
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
class Switches:
    """Unipolar switches, one a phase, and what becomes of the current when one opens.

    Attributes
    ----------
    supply
        Across a phase that is on, the switch's drop taken off [V].
    freewheel
        What the current of an opened phase runs against [V]: a diode's 0.7 V lets it fall slowly, a Zener diode or the
        supply (two transistors and two diodes a phase) quickly.  The supply where None.
    series
        Resistor in the diode's path, which takes the winding's energy [ohm].
    """

    supply: float
    freewheel: float | None = None
    series: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.supply < math.inf:
            raise ConfigError(f"must be above zero, not {self.supply:g} V", key="supply")
        for name in ("freewheel", "series"):
            value = getattr(self, name)
            if value is not None and not 0 <= value < math.inf:
                raise ConfigError(f"must be zero or more, not {value:g}: it takes energy, it gives none", key=name)

    @property
    def against(self) -> float:
        """What the current of an opened phase runs against [V]."""
        return self.supply if self.freewheel is None else self.freewheel

    def voltages(self, currents: Array, on: NDArray[np.bool_]) -> Array:
        """Return what the phases see (..., phases) [V], by their currents and whether they are on (..., phases)."""
        return np.where(on, self.supply, -self.against - self.series * currents)


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

    def holding_torque(self, current: float, on: int = 1) -> float:
        """Return the greatest torque that ``on`` neighbouring phases hold, each with this current [N·m].

        One phase: ½ I² times the greatest dL/dx, N (L_aligned - L_unaligned) I²/4.  Several are sines 2π/m apart, whose
        sum is sin(π on/m)/sin(π/m) of one.

        Raises
        ------
        ConfigError
            When the motor does not have so many phases, or has no more.
        """
        phases = self.geometry.phases
        if not 1 <= on < phases:
            raise ConfigError(f"between 1 and {phases - 1} of {phases} phases can be on, not {on}")
        one = self.geometry.teeth * (self.aligned - self.unaligned) * current * current / 4
        return one * math.sin(math.pi * on / phases) / math.sin(math.pi / phases)

    def resonance(self, current: float, load: ShaftLoad = FREE, on: int = 1) -> float:
        """Return the frequency of small swings about the stable point [Hz]: √(N T/J)/2π, T the holding torque."""
        stiffness = self.geometry.teeth * self.holding_torque(current, on)
        return math.sqrt(stiffness / (self.inertia + load.inertia)) / math.tau

    def derivative(self, state: Array, voltages: Array, load: ShaftLoad = FREE) -> Array:
        """Return d/dt of states (..., phases + 2) under phase voltages (..., phases); a current at zero only rises."""
        currents, theta, omega = np.maximum(state[..., :-2], 0.0), state[..., -2], state[..., -1]
        induced = currents * omega[..., None] * self.slope(theta)
        electric = (voltages - self.resistance * currents - induced) / self.inductance(theta)
        electric = np.where(currents > 0, electric, np.maximum(electric, 0.0))
        drag = (self.viscous + load.viscous) * omega + dry_friction(self.friction + load.friction, omega)
        net = self.torque(currents, theta) - drag - load.constant
        return np.concatenate([electric, np.stack([omega, net / (self.inertia + load.inertia)], axis=-1)], axis=-1)

    def run(
        self,
        on: NDArray[np.bool_],
        switches: Switches,
        *,
        step: float,
        load: ShaftLoad = FREE,
        state: Array | None = None,
    ) -> Array:
        """Return the states after each time step (steps, phases + 2), Runge-Kutta of fourth order.

        The plain statement of what the C core does, to read and to test against; for anything long take the twin.

        Parameters
        ----------
        on
            Which phases are on in each step (steps, phases).
        step
            Time step [s].
        state
            To begin with; at rest in line with phase 0 where None.
        """
        phases = self.geometry.phases
        y = np.zeros(phases + 2) if state is None else np.array(state, np.float64)
        out = np.empty((len(on), phases + 2))

        def rate(at: Array, row: NDArray[np.bool_]) -> Array:
            return self.derivative(at, switches.voltages(np.maximum(at[:phases], 0.0), row), load)

        for n, row in enumerate(np.asarray(on, np.bool_)):
            k1 = rate(y, row)
            k2 = rate(y + step / 2 * k1, row)
            k3 = rate(y + step / 2 * k2, row)
            k4 = rate(y + step * k3, row)
            y = y + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            y[:phases] = np.maximum(y[:phases], 0.0)
            out[n] = y
        return out
