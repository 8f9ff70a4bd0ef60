"""What follows from a catalogue's row: the numbers a reader would work out on paper.

In: a row, perhaps as wired.  Out: its derived numbers, and for a supply the speeds it reaches.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.machine.motors.curves import corner_speed, pull_out_torque

if TYPE_CHECKING:
    from trochia.machine.motors.hybrid import HybridStepper

RPM = 60.0 / math.tau  #: of 1 rad/s
_KRPM = 1000.0 / RPM  #: of 1000 rpm, in rad/s
_SPEEDS = np.geomspace(0.1, 2000.0, 4000)  #: where pull-out is looked at [rad/s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reach:
    """What a current-controlled driver of a supply gets out of a motor at its rated current, with fine microsteps.

    Attributes
    ----------
    supply
        [V].
    corner
        Speed up to which the full current flows [rad/s]; None where the supply does not drive it even at rest.
    half
        Speed where half of the torque at rest is left [rad/s]; None likewise.
    """

    supply: float
    corner: float | None
    half: float | None


def reach(motor: HybridStepper, supply: float) -> Reach:
    """Return how fast a motor is on a supply [V]."""
    try:
        corner = corner_speed(motor, supply)
    except LimitError:
        return Reach(supply=supply, corner=None, half=None)
    torque = pull_out_torque(motor, _SPEEDS, supply, current=motor.current)
    less = torque < 0.5 * motor.torque_constant * motor.current
    return Reach(supply=supply, corner=corner, half=float(_SPEEDS[np.argmax(less)]) if less.any() else None)


def derived(motor: HybridStepper) -> dict[str, float]:
    """Return what follows from a motor's parameters, by names that carry their units."""
    return {
        "torque_constant_Nm_A": motor.torque_constant,
        "back_emf_V_krpm": motor.torque_constant * _KRPM,
        "time_constant_ms": 1e3 * motor.time_constant,
        "rated_voltage_V": motor.resistance * motor.current,
        "copper_heat_W": 2.0 * motor.resistance * motor.current**2,
        "one_phase_Nm": motor.torque_constant * motor.current,
        "two_phase_Nm": math.sqrt(2.0) * motor.torque_constant * motor.current,
        "acceleration_rad_s2": math.sqrt(2.0) * motor.torque_constant * motor.current / motor.inertia,
        "resonance_Hz": math.sqrt(motor.teeth * motor.torque_constant * motor.current / motor.inertia) / math.tau,
    }
