"""Phase currents of a motor that runs evenly on a voltage drive: what supply, R, L and back-EMF make of an excitation.

In: a motor, an excitation, a voltage, a speed, a load.  Out: currents over one electrical turn, exactly: between steps
a phase is a coil on a constant voltage, and the back-EMF of an even speed is a sine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors import HybridStepper
    from trochia.pulses.excitation import Excitation

    Array = NDArray[np.float64]

_FINE = 48  # points a step


@dataclass(frozen=True, slots=True, kw_only=True)
class PhaseCurrents:
    """Currents over one electrical turn, from the first row of the excitation.

    Attributes
    ----------
    steps
        Where, in steps (points,).
    currents
        Of both phases (points, 2) [A].
    load_angle
        How far the rotor is behind the field [electrical rad].
    torque
        Most the motor gives at this speed [N·m].
    """

    steps: Array
    currents: Array
    load_angle: float
    torque: float


def phase_currents(
    motor: HybridStepper, mode: Excitation, voltage: float, omega: float, load: float = 0.0
) -> PhaseCurrents:
    """Return the currents of a motor at an even speed [rad/s], forwards, under a load torque [N·m].

    ``voltage`` [V] lies across a phase at level 1.

    Raises
    ------
    LimitError
        When the motor cannot run at that speed under that load, with what it has.
    """
    driven = _driven(motor, mode.levels * voltage, mode.step_angle / (motor.teeth * omega))
    # the field stands in each row for a step, so evenly turning it is half a step behind
    field = mode.first_angle + (np.arange(len(driven)) / _FINE - 0.5) * mode.step_angle
    # with the rotor at field less angle the mean torque is K (Im(z exp(j angle)) - brake): a sine of the angle
    z = complex((driven @ np.array([1.0, 1.0j]) * np.exp(-1j * field)).mean())
    brake = motor.torque_constant * omega * motor.resistance / float(abs(motor.impedance(np.array(omega)))) ** 2
    most = motor.torque_constant * (abs(z) - brake)
    if not most > load:
        raise LimitError(
            f"at {omega * 60 / math.tau:.4g} rpm on {voltage:g} V the motor has {max(most, 0.0):.3g} N·m, "
            f"not more than {load:g} N·m",
            hint="A lower speed or a higher supply would do.",
        )
    angle = math.asin(max(-1.0, (load / motor.torque_constant + brake) / abs(z))) - math.atan2(z.imag, z.real)
    return PhaseCurrents(
        steps=np.arange(len(driven)) / _FINE,
        currents=driven + _induced(motor, field - angle, omega),
        load_angle=math.remainder(angle, math.tau),
        torque=most,
    )


def _driven(motor: HybridStepper, volts: Array, pulse: float) -> Array:
    """Return what the voltages alone drive, periodic (rows · _FINE, phases): in every row an exponential to v/R."""
    decay = np.exp(-np.arange(_FINE + 1) / _FINE * pulse / motor.time_constant)[:, None]
    steady, whole = volts / motor.resistance, decay[-1] ** len(volts)
    at = np.zeros(volts.shape[1])
    for row in steady:
        at = row + (at - row) * decay[-1]
    at = at / (1.0 - whole)  # where one turn ends, the next begins
    parts: list[Array] = []
    for row in steady:
        parts.append(row + (at - row) * decay[:-1])
        at = row + (at - row) * decay[-1]
    return np.concatenate(parts)


def _induced(motor: HybridStepper, rotor: Array, omega: float) -> Array:
    """Return what the back-EMF alone drives at electrical angles of the rotor (points,): minus e over R + j p w L."""
    z = motor.impedance(np.array(omega))
    late, size = float(np.angle(z)), motor.torque_constant * omega / float(abs(z))
    return size * np.stack([np.sin(rotor - late), -np.cos(rotor - late)], axis=-1)
