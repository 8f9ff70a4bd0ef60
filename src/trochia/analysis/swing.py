"""How far a stepper's rotor swings about its load angle, by linear theory.

In: velocities and accelerations of a joint, block by block.  Out: the greatest load angle [electrical degree].

In synchronism the rotor is a mass on a spring: the stiffness is p T (p teeth, T holding torque), the angle at rest
under a torque f T is asin f.  A jump of acceleration makes it swing to about twice the jump; from accelerating to
braking it is a jump of both.  Each sample advances the swing exactly, for an angle at rest constant in between.

The spring softens: a step to 0.72 T from rest, by linear theory 92 degrees, is the most that a motor without damping
stands once; where one jump follows another it slips from an angle of 60 to 70 degrees on (seen on the twin).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.torque import Drive

    Floats = NDArray[np.float64]

FEWEST = 5  #: samples of a swing; with fewer nothing is told


class Swing:
    """One joint's swing, carried from block to block.

    Attributes
    ----------
    peak
        Greatest load angle so far [electrical degree]; 0 where samples are too far apart to tell.
    line
        Source line of it.
    """

    def __init__(self, motor: Drive, step: float) -> None:
        self._motor, self.peak, self.line = motor, 0.0, 0
        natural = math.sqrt(motor.made.motor.teeth * motor.made.holding / motor.inertia)
        self._told = step * natural * FEWEST <= math.tau
        damping = _damping(motor, natural)
        swinging = natural * math.sqrt(1 - damping**2)
        left = math.exp(-damping * natural * step)
        cosine, sine = left * math.cos(swinging * step), left * math.sin(swinging * step) * damping * natural / swinging
        self._b = np.array([0.0, 1 - cosine - sine, left * left - cosine + sine])
        self._a = np.array([1.0, -2 * cosine, left * left])
        self._state = np.zeros(2)

    def take(self, velocity: Floats, acceleration: Floats, line: NDArray[np.uint32]) -> None:
        """Follow a block of joint velocities and accelerations (n,), on source lines (n,)."""
        if not self._told or not len(velocity):
            return
        from scipy.signal import lfilter  # noqa: PLC0415 - scipy loads only where a machine names its motors

        motor = self._motor
        forward = np.where(velocity == 0, 1.0, np.sign(velocity / motor.per_radian))
        torque = motor.inertia * acceleration / motor.per_radian + motor.load.constant
        there = np.maximum(motor.available(velocity), 1e-9)
        dragged = torque + np.where(velocity == 0, 0.0, forward * motor.load.friction)
        rest = np.arcsin(np.clip(dragged / (there + motor.load.friction), -1.0, 1.0))
        angle, self._state = lfilter(self._b, self._a, rest, zi=self._state)
        worst = int(np.argmax(np.abs(angle)))
        found = float(np.degrees(np.abs(angle[worst])))
        if found > self.peak:
            self.peak, self.line = found, int(line[worst])


def _damping(motor: Drive, natural: float) -> float:
    """Return the damping ratio: viscous, and dry friction as it damps a swing of a radian; below 0.9."""
    own, load = motor.made.motor, motor.load
    viscous = (own.viscous + load.viscous) / (2 * natural * motor.inertia)
    dry = 2 * (own.friction + load.friction) / (math.pi * motor.made.holding)
    return min(viscous + dry, 0.9)
