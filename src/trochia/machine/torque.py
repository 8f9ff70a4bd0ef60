"""What a joint's motor can give, over speed, in the joint's own units: the crossing from shaft torque to axis motion.

In: a joint whose file names motor, driver and load.  Out: torque needed and torque there; acceleration over speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.drivers import Fed
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.machine.motors.shaft import ShaftLoad

    Floats = NDArray[np.float64]

POINTS = 32  #: of an acceleration curve


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """A joint's motor, driver and load.

    Attributes
    ----------
    made
        The motor behind its driver.
    load
        As the shaft has it.
    per_radian
        Travel of the joint for a radian of the shaft [mm or degree]; negative where it runs the other way.
    margin
        Part of the torque that planning leaves unused.
    """

    made: Fed
    load: ShaftLoad
    per_radian: float
    margin: float

    @property
    def inertia(self) -> float:
        """Of rotor and load [kg·m²]."""
        return self.made.motor.inertia + self.load.inertia

    def needed(self, velocity: Floats, acceleration: Floats) -> Floats:
        """Return the torque that inertia and the constant load ask at joint velocities and accelerations (...) [N·m].

        Frictions are not in it: :meth:`available` has them off.  Positive is along the motion, so braking counts below
        zero where the load helps; at rest the magnitude.
        """
        torque = self.inertia * acceleration / self.per_radian + self.load.constant
        return np.where(velocity == 0, np.abs(torque), torque * np.sign(velocity / self.per_radian))

    def available(self, velocity: Floats) -> Floats:
        """Return the torque at which the motor falls out of step at joint velocities (...) [N·m], less frictions."""
        return self.made.pull_out(np.abs(velocity / self.per_radian), self.load)

    def braking(self, velocity: Floats) -> Floats:
        """Return the greatest braking torque before it falls out of step (...) [N·m]: frictions help here."""
        return self.available(velocity) + 2 * self.frictions(velocity)

    def frictions(self, velocity: Floats) -> Floats:
        """Return what frictions of motor and load take at joint velocities (...) [N·m], dry and viscous."""
        viscous = (self.made.motor.viscous + self.load.viscous) * np.abs(velocity / self.per_radian)
        return self.made.motor.friction + self.load.friction + viscous

    def used(self, velocity: Floats, acceleration: Floats) -> Floats:
        """Return which part of the torque there is a motion uses (...): above 1 it loses steps."""
        needed = self.needed(velocity, acceleration)
        there = np.where(needed < 0, self.braking(velocity), self.available(velocity))
        # no torque at all: frictions alone hold the motor, whatever is asked
        return np.where(there > 0, np.abs(needed) / np.where(there > 0, there, 1.0), np.inf)

    @property
    def greatest_velocity(self) -> float:
        """Joint velocity at which the torque that planning may use just carries the load [mm/s or degree/s]."""
        return _crossing(self) * abs(self.per_radian)

    def acceleration(self, velocity: Floats) -> Floats:
        """Return the acceleration that planning may use at joint velocities (...) [mm/s², degree/s²], zero or more."""
        spare = (1 - self.margin) * self.available(velocity) - abs(self.load.constant)
        return np.maximum(spare, 0.0) * abs(self.per_radian) / self.inertia


def drive(machine: Machine, index: int) -> Drive | None:
    """Return motor, driver and load of a joint by its number; None where the file does not name motor and driver."""
    joint = machine.joints[index]
    made = joint.fed
    if made is None:
        return None
    row = machine.kinematics.matrix[index]
    rotary = any(axis.rotary for axis, c in zip(machine.axes, row, strict=True) if c)
    return joint_drive(joint, made, rotary=rotary)


def joint_drive(joint: Joint, made: Fed, *, rotary: bool) -> Drive:
    """Return motor, driver and load of a joint in degrees (``rotary``) or mm."""
    return Drive(
        made=made,
        load=joint.load.at_shaft(joint.transmission.travel_per_turn, rotary=rotary),
        per_radian=float(joint.transmission.travel_per_turn) / math.tau,
        margin=joint.load.margin,
    )


def acceleration_curve(drive: Drive, velocity: float, points: int = POINTS) -> tuple[Floats, Floats]:
    """Return speeds (points,), rising from 0 to ``velocity``, and the acceleration planning may use at each (points,).

    In the joint's units [mm/s, mm/s²; degrees].

    Raises
    ------
    ConfigError
        When the motor does not reach ``velocity`` under its load, naming the velocity it does reach.
    """
    speeds = np.linspace(0.0, velocity, points)
    accelerations = drive.acceleration(speeds)
    if accelerations[-1] <= 0:
        reached = drive.greatest_velocity
        raise ConfigError(
            f"{velocity:g} is beyond what the motor reaches under its load, {reached:.4g}",
            key="velocity",
            hint=f"At most {0.95 * reached:.4g} would do.",
        )
    return speeds, accelerations


def _crossing(drive: Drive) -> float:
    """Return the shaft speed at which usable torque meets the load [rad/s]."""

    def spare(omega: float) -> float:
        return float(drive.acceleration(np.array(omega * drive.per_radian)))

    low, high = 0.0, 1.0
    while spare(high) > 0 and high < 1e6:
        low, high = high, 2 * high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if spare(middle) > 0 else (low, middle)
    return low
