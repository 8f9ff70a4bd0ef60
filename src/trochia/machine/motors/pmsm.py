"""The synchronous motor of permanent magnets, in the frame that turns with its rotor.

    Ld di_d/dt = v_d - R i_d + p w Lq i_q
    Lq di_q/dt = v_q - R i_q - p w (Ld i_d + psi)
    torque = 3/2 p (psi i_q + (Ld - Lq) i_d i_q)            J dw/dt = torque - b w - load

Currents and voltages are peaks of a phase (the transform that keeps amplitudes), p the pairs of poles, psi the magnets'
flux.  With i_d held at zero it is a motor of direct current with Kt = 3/2 p psi and Kb = p psi = 2/3 Kt (Krause,
*Analysis of Electric Machinery*).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.motors.dc import DcMotor

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Pmsm:
    """Parameters; a state is (i_d [A], i_q [A], speed [rad/s]).

    Attributes
    ----------
    flux
        Of the magnets through a phase [Wb].
    viscous
        b [N·m·s/rad].
    """

    resistance: float
    inductance_d: float
    inductance_q: float
    flux: float
    pole_pairs: int
    inertia: float
    viscous: float = 0.0

    def __post_init__(self) -> None:
        for name in ("resistance", "inductance_d", "inductance_q", "flux", "pole_pairs", "inertia"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ConfigError(f"must be above zero, not {getattr(self, name)!r}", key=name)

    def torque(self, i_d: NDArray[np.float64], i_q: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the torque of currents (...) [N·m]."""
        return 1.5 * self.pole_pairs * (self.flux + (self.inductance_d - self.inductance_q) * i_d) * i_q

    def derivative(self, state: NDArray[np.float64], v_d: float, v_q: float, load: float = 0.0) -> NDArray[np.float64]:
        """Return d/dt of states (..., 3) under voltages [V] and a load torque [N·m]."""
        i_d, i_q, speed = state[..., 0], state[..., 1], state[..., 2]
        electric = self.pole_pairs * speed
        return np.stack([
            (v_d - self.resistance * i_d + electric * self.inductance_q * i_q) / self.inductance_d,
            (v_q - self.resistance * i_q - electric * (self.inductance_d * i_d + self.flux)) / self.inductance_q,
            (self.torque(i_d, i_q) - self.viscous * speed - load) / self.inertia,
        ], axis=-1)  # fmt: skip

    def as_dc(self) -> DcMotor:
        """Return the motor of direct current that it is while i_d is held at zero."""
        emf = self.pole_pairs * self.flux
        return DcMotor(
            resistance=self.resistance, inductance=self.inductance_q, inertia=self.inertia,
            torque_constant=1.5 * emf, emf_constant=emf, viscous=self.viscous,
        )  # fmt: skip

    def voltage(self, i_q: float, speed: float) -> float:
        """Return the peak phase voltage that a steady i_q (with i_d = 0) needs at a speed [V]."""
        electric = self.pole_pairs * speed
        return math.hypot(electric * self.inductance_q * i_q, self.resistance * i_q + electric * self.flux)

    def most_current(self, speed: float, voltage: float) -> float:
        """Return the greatest i_q along the motion at a speed [A], of a peak phase voltage; below 0: it must brake.

        The bridge gives at most its supply over √3.
        """
        electric = self.pole_pairs * speed
        reactance = electric * self.inductance_q
        square = self.resistance**2 + reactance**2
        emf = electric * self.flux
        # (R i + emf)² + (X i)² = V²
        root = voltage**2 * square - (reactance * emf) ** 2
        return (-self.resistance * emf + math.sqrt(root)) / square if root >= 0 else -math.inf
