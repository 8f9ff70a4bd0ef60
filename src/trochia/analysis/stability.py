"""Whether a voltage-fed stepper runs steadily: the mid-band instability by linear theory.

In: a motor, a speed and the amplitude of the phase voltage.  Out: how fast a small disturbance grows or dies.

The equations, seen from the rotor, are constant at constant speed.  With the voltage at the angle d before the q axis
(i_d, i_q currents along and across the rotor's magnet, w speed, p teeth, K torque constant):

    L di_d/dt = -V sin d - R i_d + p w L i_q
    L di_q/dt =  V cos d - R i_q - p w L i_d - K w
    J dw/dt   =  K i_q - B w - load                  dd/dt = p (w_field - w)

Detent torque and the ripple of coarse steps average out and are left out.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.machine.motors.hybrid import FREE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.motors import HybridStepper, ShaftLoad


def steady_angle(motor: HybridStepper, omega: float, voltage: float, load: ShaftLoad = FREE) -> float:
    """Return the angle d [electrical rad] at which the motor carries its load at a shaft speed [rad/s], >= 0.

    Raises
    ------
    LimitError
        When the torque does not suffice there.
    """
    z = complex(motor.impedance(np.array(omega)))
    k = motor.torque_constant
    needed = load.constant + load.friction + motor.friction + (load.viscous + motor.viscous) * omega
    share = (needed + k * k * omega * motor.resistance / abs(z) ** 2) * abs(z) / (k * voltage)
    if abs(share) > 1:
        raise LimitError(f"at {omega:g} rad/s the motor does not carry its load from {voltage:g} V")
    # of the two angles the one where a rotor that falls behind gains torque
    return math.atan2(z.imag, z.real) - math.acos(share)


def growth_rate(motor: HybridStepper, omega: float, voltage: float, load: ShaftLoad = FREE) -> float:
    """Return the growth rate of the slowest small disturbance [1/s]: above zero the motor does not run steadily.

    The greatest real part of the eigenvalues of the linearised equations.

    Parameters
    ----------
    omega
        Of the shaft, zero or more [rad/s].
    voltage
        Amplitude of the fundamental at a phase [V].

    Raises
    ------
    LimitError
        As :func:`steady_angle`.
    """
    return float(_modes(motor, omega, voltage, load).real.max())


def swing_mode(motor: HybridStepper, omega: float, voltage: float, load: ShaftLoad = FREE) -> complex:
    """Return how a small swing goes on, exp(λ t) [1/s]: decay or growth, and frequency [rad/s], of the slowest one.

    Raises
    ------
    LimitError
        As :func:`steady_angle`.
    """
    modes = _modes(motor, omega, voltage, load)
    slowest = modes[int(np.argmax(modes.real))]
    return complex(slowest.real, abs(slowest.imag))


def _modes(motor: HybridStepper, omega: float, voltage: float, load: ShaftLoad) -> NDArray[np.complexfloating]:
    """Return the eigenvalues of the linearised equations (4,)."""
    d = steady_angle(motor, omega, voltage, load)
    r, x = motor.resistance, motor.teeth * omega * motor.inductance
    v_d, v_q = -voltage * math.sin(d), voltage * math.cos(d) - motor.torque_constant * omega
    i_d, i_q = np.linalg.solve(np.array([[r, -x], [x, r]]), np.array([v_d, v_q]))
    inertia, p, k, inductance = motor.inertia + load.inertia, motor.teeth, motor.torque_constant, motor.inductance
    matrix = np.array([
        [-r / inductance, p * omega, p * i_q, -voltage * math.cos(d) / inductance],
        [-p * omega, -r / inductance, -p * i_d - k / inductance, -voltage * math.sin(d) / inductance],
        [0.0, k / inertia, -(motor.viscous + load.viscous) / inertia, 0.0],
        [0.0, 0.0, -p, 0.0],
    ])  # fmt: skip
    return np.asarray(np.linalg.eigvals(matrix), np.complex128)
