"""What a servo loop has in front of it: amplifier, motor, drive train, load, encoder.

In: parameters in motor space (SI; a slide's ways and forces serve as well as a rotation's angles and torques).  Out:
the equations of ``core/host/servo.h``, as the derivative of a state, and the transfer function of the linear part.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.friction import FRICTIONLESS, Friction

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.edges import Edges


class Mode(Enum):
    """What an amplifier makes of its command."""

    VOLTAGE = 0
    CURRENT = 1
    SPEED = 2


class Power(Enum):
    """What an amplifier does with the winding."""

    DRIVEN = 0
    BRAKED = 1
    FREE = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Amplifier:
    """From a command to volts or amperes.

    Attributes
    ----------
    gain
        Volts, amperes or speed a unit of command.
    voltage, current
        The most it gives [V, A].
    drop
        Lost in the bridge, against the current [V]; an L298 takes about 2 V.
    levels
        Steps of its PWM over the whole voltage (1023 of 10 bits); None: no steps.
    lag
        Time constant of the current loop inside it [s].
    offset
        That it adds to its command.
    speed_gain, speed_integral
        Of the speed loop inside one that sets the speed [A·s/rad, A/rad].
    """

    mode: Mode = Mode.CURRENT
    gain: float = 1.0
    voltage: float = math.inf
    current: float = math.inf
    drop: float = 0.0
    levels: int | None = None
    lag: float = 0.0
    offset: float = 0.0
    speed_gain: float = 0.0
    speed_integral: float = 0.0


class Gains(NamedTuple):
    """A transfer function, highest power of s first."""

    numerator: NDArray[np.float64]
    denominator: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoPlant:
    """One axis as its loop sees it.

    Attributes
    ----------
    resistance, inductance
        Of the winding; they matter to an amplifier of voltage [ohm, H].
    torque_constant, emf_constant
        [N·m/A or N/A, V·s/rad or V·s/m].
    motor_inertia, load_inertia
        On either side of the drive train [kg·m² or kg].
    stiffness, damping, gap
        Of the train; ``stiffness`` None: rigid.  ``gap`` is the whole width of its play, at the motor.
    load
        Against positive motion.
    counts
        Of the encoder, a unit of motion; None: exact.
    on_load
        Whether the encoder reads the load.
    edges
        Of the encoder, where they are looked at one by one.
    """

    amplifier: Amplifier = Amplifier()
    resistance: float = 1.0
    inductance: float = 0.0
    torque_constant: float = 1.0
    emf_constant: float = 0.0
    motor_inertia: float
    load_inertia: float = 0.0
    stiffness: float | None = None
    damping: float = 0.0
    gap: float = 0.0
    motor_friction: Friction = FRICTIONLESS
    load_friction: Friction = FRICTIONLESS
    load: float = 0.0
    counts: float | None = None
    on_load: bool = False
    edges: Edges | None = None

    def __post_init__(self) -> None:
        for name in ("motor_inertia", "resistance", "torque_constant"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ConfigError(f"must be above zero, not {getattr(self, name)!r}", key=name)
        for name in ("load_inertia", "inductance", "emf_constant", "damping", "gap"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ConfigError(f"must not be below zero, not {getattr(self, name)!r}", key=name)
        if self.stiffness is not None and not (self.stiffness > 0.0 and self.load_inertia > 0.0):
            raise ConfigError("a drive train that is not rigid needs a stiffness and a load's inertia above zero",
                              key="stiffness")  # fmt: skip
        if self.stiffness is None and self.gap > 0.0:
            raise ConfigError("a gap needs a drive train with a stiffness", key="gap")
        if self.edges is not None and not self.counts:
            raise ConfigError("needs counts: an exact encoder has no edges", key="edges")

    @property
    def rigid(self) -> bool:
        """Whether motor and load are one body."""
        return self.stiffness is None

    def derivative(self, state: NDArray[np.float64], command: float, disturbance: float = 0.0) -> NDArray[np.float64]:
        """Return d/dt of (motor, load, motor speed, load speed, current) under a command, no steps and no limits.

        Without inductance (or lag) the current follows at once and its entry is ignored.  An amplifier that sets the
        speed has a sixth state: the sum of its speed loop [A].
        """
        x, y, w, z, i, *sums = state
        amplifier = self.amplifier
        tau = self.inductance / self.resistance if amplifier.mode is Mode.VOLTAGE else amplifier.lag
        target = amplifier.gain * command
        error = target - w
        if amplifier.mode is Mode.VOLTAGE:
            target = (target - self.emf_constant * w) / self.resistance
        elif amplifier.mode is Mode.SPEED:
            target = amplifier.speed_gain * error + sums[0]
        more = [amplifier.speed_integral * error] * len(sums)
        current = i if tau > 0.0 else target
        drive = self.torque_constant * current - float(self.motor_friction.force(np.asarray(w)))
        against = float(self.load_friction.force(np.asarray(z))) + self.load + disturbance
        rate = (target - i) / tau if tau > 0.0 else 0.0
        if self.stiffness is None:
            a = (drive - against) / (self.motor_inertia + self.load_inertia)
            return np.array([w, w, a, a, rate, *more])
        twist, half = x - y, 0.5 * self.gap
        touching = abs(twist) > half or half == 0.0
        c = self.stiffness * (twist - math.copysign(min(abs(twist), half), twist)) + self.damping * (w - z) * touching
        return np.array([w, z, (drive - c) / self.motor_inertia, (c - against) / self.load_inertia, rate, *more])

    def linear(self, *, of_load: bool = False) -> Gains:
        """Return position by command of the linear part: no dry friction, no gap, no limits.

        The position is that of the motor, or of the load.
        """
        b1, b2 = self.motor_friction.viscous, self.load_friction.viscous
        poly = np.polynomial.polynomial
        if self.stiffness is None:
            body = np.array([0.0, b1 + b2, self.motor_inertia + self.load_inertia])
            over = np.ones(1)
        else:
            train = np.array([self.stiffness, self.damping])
            motor = poly.polyadd([0.0, b1, self.motor_inertia], train)
            load = poly.polyadd([0.0, b2, self.load_inertia], train)
            body = poly.polysub(poly.polymul(motor, load), poly.polymul(train, train))
            over = train if of_load else load
        amplifier, inner = self.amplifier, self._inner()
        speed = self.torque_constant * poly.polymul([0.0, 1.0], inner)  # of the motor, by a unit of current
        if amplifier.mode is Mode.VOLTAGE:
            winding = np.array([self.resistance, self.inductance])
            whole = poly.polyadd(poly.polymul(winding, body), self.emf_constant * speed)
        elif amplifier.mode is Mode.SPEED:
            own = np.array([amplifier.speed_integral, amplifier.speed_gain])
            whole = poly.polyadd(poly.polymul([0.0, 1.0, amplifier.lag], body), poly.polymul(own, speed))
            over = poly.polymul(own, over)
        else:
            whole = poly.polymul([1.0, amplifier.lag], body)
        gain = amplifier.gain * self.torque_constant
        numerator, denominator = (np.trim_zeros(p, "b")[::-1] for p in (gain * over, whole))
        return Gains(np.asarray(numerator, np.float64), np.asarray(denominator, np.float64))

    def _inner(self) -> NDArray[np.float64]:
        """Return the motor's share of the body: position of the motor by torque is this over the body."""
        if self.stiffness is None:
            return np.ones(1)
        return np.array([self.stiffness, self.damping + self.load_friction.viscous, self.load_inertia])
