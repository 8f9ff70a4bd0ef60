"""Closed forms of a stepper's torque: holding, pull-out over speed, corner speed, start/stop speed.

In: a motor's parameters and what drives it.  Out: torques [N·m] and speeds of the shaft [rad/s].

Symbols: K torque constant, p rotor teeth, R, L of a phase, V amplitude of the sinusoidal phase voltage, w shaft speed.
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
    from trochia.machine.motors.excitation import Excitation

    Array = NDArray[np.float64]


def holding_torque(motor: HybridStepper, excitation: Excitation, current: float | None = None) -> float:
    """Return the greatest torque the current holds at rest [N·m]: K I with one phase, √2 K I with both; no detent.

    ``current`` [A] is a phase's at level 1, rated where not given.
    """
    return motor.torque_constant * (motor.current if current is None else current) * excitation.peak


def pull_out_torque(
    motor: HybridStepper, omega: Array, voltage: float, *, current: float | None = None, load: ShaftLoad = FREE
) -> Array:
    """Return the torque at which the motor falls out of step at shaft speeds (...) [N·m]; below zero: it cannot run.

    With the speed steady, currents are sinusoidal and the torque is greatest over the load angle where the voltage's
    part of it peaks:

        T = K V/|Z| - K² w R/|Z|² - B w - friction        Z = R + j p w L

    Parameters
    ----------
    voltage
        Amplitude V of the fundamental at a phase [V]: the supply times ``Excitation.fundamental``.
    current
        What a current controller holds a phase's amplitude to [A]: up to the corner speed the torque is K times it,
        above it both bind (see :func:`_limited`).
    load
        Its frictions are taken off, with the motor's own; its constant torque is not.
    """
    speed = np.abs(np.asarray(omega, np.float64))
    k = motor.torque_constant
    across = (
        voltage / np.abs(motor.impedance(speed)) - k * speed * motor.resistance / np.abs(motor.impedance(speed)) ** 2
    )
    if current is not None:
        across = _limited(motor, speed, voltage, current, across)
    return k * across - (motor.viscous + load.viscous) * speed - motor.friction - load.friction


def _limited(motor: HybridStepper, speed: Array, voltage: float, current: float, across: Array) -> Array:
    """Return the greatest current across the magnet (i_q) within a current limit and a voltage limit (...) [A].

    In the plane of (i_d, i_q) the current limit is a disc of radius I about zero, the voltage limit one of radius V/|Z|
    about -K w (X, R)/|Z|².  The greatest i_q of both lies on top of either disc, where that lies in the other, or where
    the two circles cross.  Discs that do not meet: back-EMF drives more than the current that is set, and there is no
    running at that speed; the point of the current's disc next to the other has i_q below zero, and goes on from there.
    """
    z = motor.impedance(speed)
    size = np.abs(z)
    back = motor.torque_constant * speed / size**2
    d, q, radius = -back * z.imag, -back * z.real, voltage / size
    apart = np.hypot(d, q)
    on_top = np.hypot(d, current - q) <= radius  # the current's own best point needs no more than the voltage
    inside = np.hypot(d, across) <= current  # the voltage's own best point needs no more than the current
    safe = np.where(apart > 0, apart, 1.0)
    along = np.clip((current**2 - radius**2 + apart**2) / (2 * safe), -current, current)
    beside = np.sqrt(np.maximum(current**2 - along**2, 0.0))
    crossing = along * q / safe + beside * np.abs(d) / safe
    return np.where(on_top, current, np.where(inside, np.minimum(across, current), crossing))


def corner_speed(motor: HybridStepper, voltage: float, current: float | None = None) -> float:
    """Return the speed up to which the supply can drive a current in phase with the back-EMF [rad/s].

    The positive root of V² = (R I + K w)² + (p w L I)².  ``current`` [A] is rated where not given.

    Raises
    ------
    LimitError
        When the voltage does not drive that current even at rest.
    """
    i = motor.current if current is None else current
    drop = motor.resistance * i
    if voltage <= drop:
        raise LimitError(f"{voltage:g} V does not drive {i:g} A through {motor.resistance:g} ohm at rest",
                         hint=f"It takes more than {drop:.3g} V, or a current below "
                              f"{voltage / motor.resistance:.3g} A.")  # fmt: skip
    square = motor.torque_constant**2 + (motor.teeth * motor.inductance * i) ** 2
    half = drop * motor.torque_constant
    # of the two ways to write the root, the one that subtracts nothing from its like
    rest = (voltage - drop) * (voltage + drop)
    return rest / (half + math.sqrt(half * half + square * rest))


def start_stop_speed(
    motor: HybridStepper, torque: float, *, load: ShaftLoad = FREE, step_angle: float = math.pi / 2
) -> float:
    """Return an estimate of the highest speed the motor starts at without a ramp [rad/s].

    Seen from a field of constant strength that turns at w, the rotor begins with the slip w, half a step behind its
    rest, and must not climb over the next unstable point (equal areas):

        ½ J w² = (T/p) (cos d0 + cos r) - T_load (π - r - d0)/p      sin r = T_load/T,  d0 = r + half a step

    However slowly, it must not pass that point at the first step either: r + a step < π - r.
    No damping, which would help, and no inductance, which hinders: an estimate, best at low speed and fine steps.

    Parameters
    ----------
    torque
        Amplitude of torque over load angle [N·m]: the holding torque of the excitation.
    step_angle
        What a step turns the field by [electrical rad]; a full step where not given.

    Raises
    ------
    LimitError
        When the load is more than the torque, or leaves no way to start.
    """
    against = load.constant + load.friction + motor.friction
    if not abs(against) < torque:
        raise LimitError(f"a load of {against:g} N·m cannot be turned by {torque:g} N·m")
    rest = math.asin(against / torque)
    begin = rest + step_angle / 2
    if rest + step_angle >= math.pi - rest:
        greatest = torque * math.cos(step_angle / 2)
        raise LimitError(f"under a load of {against:g} N·m a torque of {torque:g} N·m does not take the first step",
                         hint=f"Such steps start against less than {greatest:.3g} N·m; finer ones, more.")  # fmt: skip
    climb = torque * (math.cos(begin) + math.cos(rest)) - against * (math.pi - rest - begin)
    return math.sqrt(2 * climb / (motor.teeth * (motor.inertia + load.inertia)))
