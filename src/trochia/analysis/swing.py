"""How far a stepper's rotor swings about its load angle, by linear theory.

In: positions, velocities and accelerations of a joint, block by block.  Out: the greatest swing, as a part of what is
safe, and where.

In synchronism the rotor is a mass on a spring: the stiffness is p T (p teeth, T torque there is), the angle at rest
under a torque f T is r = asin f.  What moves that angle sets it swinging: acceleration that jumps, steps that are
coarse, detent.  A swing goes on as exp(λ t), λ by the linear theory of a motor on a bridge (``stability.py``), or as a
chopper damps it (see :func:`_chopped`); each sample advances it exactly.  A swing of amplitude A about r has the energy
½ T cos r A²; over the top it comes with T (2 cos r - (π - 2 r) sin r), so

    over = A sqrt(½ cos r / (2 cos r - (π - 2 r) sin r))

which a step of torque from 0 to 0.72 T, the most a motor without damping stands, brings to 0.9.  The spring softens, so
great swings fall out of time with the steps that feed them: the coarser those, the more linear theory overrates them.
Up to what it tells is safe (``SAFE``, ``COARSE``) is found on the twin (tests/soak/lost_steps.py).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.ripple import Ripple
from trochia.analysis.stability import swing_mode
from trochia.errors import LimitError
from trochia.machine.motors import ShaftLoad

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.machine.drivers import Fed
    from trochia.machine.torque import Drive

    Floats = NDArray[np.float64]
    Complexes = NDArray[np.complexfloating]

SAFE = 0.55  #: part of the swing that takes a rotor over the top, by linear theory, from which on it may slip
COARSE = {True: 0.35, False: 1.4}  #: more for each rad by which the field ripples: behind a chopper, on a bridge
FEWEST = 12  #: samples of a swing; with fewer nothing is told
SPEEDS = 48  #: at which λ is found
CHUNK = 64  #: samples that are advanced together
STEEPEST = 0.9  #: sine of the greatest angle at rest; above, the torque is all but used up, and that is told
LARGE = 10.0  #: amplitude no swing passes [rad]: it slipped long before
ONSETS = ((0.0, 0.3, 1.0), (0.35, 0.95, 1.9))  #: part of the off time that is fast; of the corner, where swings grow
GROWTH = 0.03  #: of the frequency: how fast they grow there


class Swing:
    """One joint's swing, carried from block to block.

    Parameters
    ----------
    step
        Time between samples [s].
    top
        Greatest velocity of the joint [mm/s or degree/s].
    steps
        Steps of the joint a mm or degree.

    Attributes
    ----------
    part
        Greatest swing so far, of what is safe; 0 where samples are too far apart to tell.
    line
        Source line in which it first passed what is safe, or else of the greatest.
    velocity, grows
        Of the joint there; whether swings grow at that speed by themselves.
    """

    def __init__(self, motor: Drive, step: float, top: float, steps: float) -> None:
        self._motor, self._step, self._steps = motor, step, steps
        self.part, self.line, self.velocity, self.grows = 0.0, 0, 0.0, False
        self._told = step * natural(motor) * FEWEST <= math.tau
        self._ripple = Ripple(motor.made)
        self._safe = SAFE + COARSE[motor.made.chopper is not None] * self._ripple.greatest
        self._speeds = np.linspace(0.0, max(top / abs(motor.per_radian), 1e-6), SPEEDS)
        self._modes = modes(motor, self._speeds)
        self._rest, self._state = math.nan, 0j

    def take(self, position: Floats, velocity: Floats, acceleration: Floats, line: NDArray[np.uint32]) -> None:
        """Follow a block of joint positions, velocities and accelerations (n,), on source lines (n,)."""
        if not self._told or not len(velocity):
            return
        motor, frictions = self._motor, self._motor.frictions(velocity)
        omega = velocity / motor.per_radian
        dragged = motor.inertia * acceleration / motor.per_radian + motor.load.constant + np.sign(omega) * frictions
        there = np.maximum(motor.available(velocity) + frictions, 1e-12)
        rest = np.arcsin(np.clip(dragged / there, -STEEPEST, STEEPEST))
        half = 0.5 * self._step * velocity
        at = self._steps * np.concatenate([position - half, position[-1:] + half[-1:]])
        target = rest - self._ripple.mean(at)
        before = target[:1] if math.isnan(self._rest) else [self._rest]
        self._rest = float(target[-1])
        rate = self._rate(np.abs(omega))
        swing = self._advanced(np.exp(self._step * rate), -np.diff(target, prepend=before))
        part = np.abs(swing) / (self._safe * _most(np.abs(rest)))
        self._tell(part, line, velocity, rate)

    def _rate(self, speed: Floats) -> Complexes:
        """Return λ at shaft speeds (n,), with dry friction's damping of a swing of a radian."""
        motor = self._motor
        found = np.interp(speed, self._speeds, self._modes.real) + 1j * np.interp(speed, self._speeds, self._modes.imag)
        turning = np.maximum(found.imag, 1e-6) / motor.made.motor.teeth  # greatest speed of such a swing
        back = np.sqrt(np.maximum(1 - (speed / turning) ** 2, 0.0))  # nothing unless the shaft turns back in it
        dry = (motor.made.motor.friction + motor.load.friction) * 4 / (math.pi * turning) * back
        return np.maximum(found.real - dry / (2 * motor.inertia), -1 / self._step) + 1j * found.imag

    def _advanced(self, factor: Complexes, jump: Floats) -> Complexes:
        """Return z (n,) with z = factor (z before + jump), going on from the block before."""
        n = len(jump)
        rows = -(-n // CHUNK)
        factors, jumps = np.ones(rows * CHUNK, np.complex128), np.zeros(rows * CHUNK)
        factors[:n], jumps[:n] = factor, jump
        product = np.cumprod(factors.reshape(rows, CHUNK), axis=1)
        before = np.concatenate([np.ones((rows, 1)), product[:, :-1]], axis=1)
        own = product * np.cumsum(jumps.reshape(rows, CHUNK) / before, axis=1)
        starts = np.zeros(rows, np.complex128)
        for row, (end, made) in enumerate(zip(product[:, -1].tolist(), own[:, -1].tolist(), strict=True)):
            starts[row] = self._state
            after = end * self._state + made
            self._state = after if abs(after) < LARGE else after / abs(after) * LARGE
        return (own + product * starts[:, None]).ravel()[:n]

    def _tell(self, part: Floats, line: NDArray[np.uint32], velocity: Floats, rate: Complexes) -> None:
        """Remember the greatest, and the first that is not safe."""
        worst = int(np.argmax(part))
        if part[worst] <= self.part:
            return
        if self.part <= 1.0:
            first = int(np.argmax(part > 1.0)) if part[worst] > 1.0 else worst
            self.line, self.velocity = int(line[first]), float(velocity[first])
            self.grows = bool(rate[first].real > 0)
        self.part = float(part[worst])


def natural(motor: Drive) -> float:
    """Return the frequency of small swings at rest [rad/s]."""
    return math.sqrt(motor.made.motor.teeth * motor.made.holding / motor.inertia)


def modes(motor: Drive, speeds: Floats) -> Complexes:
    """Return λ of a swing at shaft speeds (n,), rising from zero [1/s]."""
    found: Callable[[float], complex] = _bridged(motor) if motor.made.chopper is None else _chopped(motor)
    return np.array([found(speed) for speed in speeds.tolist()], np.complex128)


def _bridged(motor: Drive) -> Callable[[float], complex]:
    """Return λ over speed of a motor on a bridge: the linear theory; where it does not run, as at the speed before."""
    load = motor.load
    against = ShaftLoad(inertia=load.inertia, friction=load.friction, viscous=load.viscous)
    last = complex(0.0, natural(motor))

    def found(speed: float) -> complex:
        nonlocal last
        try:
            mode = swing_mode(motor.made.motor, speed, motor.made.amplitude, against)
        except LimitError:
            return last
        # a swing that no longer swings dies out, or falls, by itself
        last = complex(mode.real, mode.imag or last.imag)
        return last

    return found


def _chopped(motor: Drive) -> Callable[[float], complex]:
    """Return λ over speed of a motor behind a chopper.

    Up to some speed its currents are what is set, whatever the rotor does, less half the ripple, which grows with the
    back-EMF: that damps as a conductance of off time/2 L would.  Above, a phase's current no longer falls as fast as it
    should, and the faster it is made to fall the later that begins (``ONSETS``, in parts of the speed at which the
    supply drives the current through coil and back-EMF without load; found on the twin on 45 motors).
    """
    made, load, chopper = motor.made, motor.load, motor.made.chopper
    assert chopper is not None
    own, amplitude = made.motor, made.current_amplitude or made.current
    onset = float(np.interp(chopper.fast_part, *ONSETS)) * light_corner(made)
    damping = own.torque_constant**2 * chopper.off_time / (2 * own.inductance)
    viscous = own.viscous + load.viscous

    def found(speed: float) -> complex:
        there = float(made.pull_out(np.array(speed)))
        swinging = math.sqrt(own.teeth * max(there, 0.05 * own.torque_constant * amplitude) / motor.inertia)
        own_way = GROWTH * swinging if speed > onset else -damping / (2 * motor.inertia)
        return complex(own_way - viscous / (2 * motor.inertia), swinging)

    return found


def light_corner(made: Fed) -> float:
    """Return the shaft speed up to which the supply drives a chopper's current where there is no load [rad/s].

    The current then lies along the magnet, across its back-EMF: V² = (R I)² + (p w L I + K w)².
    """
    own, current = made.motor, made.current_amplitude or made.current
    drop = own.resistance * current
    rest = math.sqrt(max(made.amplitude**2 - drop * drop, 0.0))
    return rest / (own.teeth * own.inductance * current + own.torque_constant)


def _most(rest: Floats) -> Floats:
    """Return the amplitude (n,) that takes a rotor over the top, from an angle at rest (n,) [rad]."""
    over = 2 * np.cos(rest) - (math.pi - 2 * rest) * np.sin(rest)
    return np.sqrt(2 * over / np.cos(rest))
