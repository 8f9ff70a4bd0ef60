"""A servo joint in motor space: the crossing from axis travel to the shaft, and what its motor gives by closed forms.

In: a joint whose file names motor, amplifier and loop.  Out: a ServoPlant in SI units of the shaft, counted positive
where the joint's travel is, and torque and speed there are.

A turn of the shaft moves the joint by s, so one radian is s/2π of travel: exact until this one division.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Mode, ServoPlant
from trochia.machine.servos.motors import CataloguePmsm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.machine.motors.shaft import ShaftLoad
    from trochia.machine.servos.amplifier import DriveTrain, ServoAmplifier
    from trochia.machine.servos.loops import ServoLoop
    from trochia.machine.servos.motors import CatalogueDc

    Floats = NDArray[np.float64]

SMOOTH = 0.05  #: speed over which dry friction turns its sign, at least [rad/s]: it creeps instead of sticking
_STEP = 1e-5  #: time step of the plant that friction must be smooth for [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoDrive:
    """A joint's motor, amplifier, train and load, with the loop's data.

    Attributes
    ----------
    plant
        In SI units of the shaft.
    per_radian
        Travel for a radian of the shaft [mm or degree], above zero: the shaft is counted as the joint is.
    friction
        Dry friction of motor and load [N·m].
    play
        Backlash that follows behind motor and load [mm or degree]; 0 where the train's spring has it.
    current
        What the motor may carry for ever [A].
    """

    catalogue: CatalogueDc | CataloguePmsm
    amplifier: ServoAmplifier
    loop: ServoLoop
    plant: ServoPlant
    per_radian: float
    friction: float
    play: float
    period: float

    @property
    def inertia(self) -> float:
        """Of rotor and load [kg·m²]."""
        return self.plant.motor_inertia + self.plant.load_inertia

    @property
    def current(self) -> float:
        """What the motor may carry for ever [A]; infinite where nothing is said."""
        return self.catalogue.current or math.inf

    def needed(self, velocity: Floats, acceleration: Floats) -> Floats:
        """Return the motor's torque along joint velocities and accelerations (...) [N·m], frictions included."""
        speed = velocity / self.per_radian
        viscous = self.plant.motor_friction.viscous + self.plant.load_friction.viscous
        dry = self.friction * np.sign(speed)
        return self.inertia * acceleration / self.per_radian + viscous * speed + dry + self.plant.load

    def available(self, velocity: Floats) -> Floats:
        """Return the greatest torque along positive joint velocities (...) [N·m]; below 0 where it can only brake.

        The current's limit, and what the supply leaves over the back-EMF.
        """
        speed = np.abs(velocity) / self.per_radian
        plant, supply = self.plant, self.amplifier.voltage
        most = plant.amplifier.current
        current = np.full(np.shape(speed), most)
        if supply is not None and isinstance(self.catalogue, CataloguePmsm):
            pmsm, phase = self.catalogue.pmsm, supply / math.sqrt(3)
            most_at = np.array([pmsm.most_current(float(w), phase) for w in np.ravel(speed)]).reshape(np.shape(speed))
            current = np.minimum(current, most_at)
        elif supply is not None:
            spare = supply - self.amplifier.whole_drop - plant.emf_constant * speed
            current = np.minimum(current, spare / plant.resistance)
        return plant.torque_constant * current

    def used(self, velocity: Floats, acceleration: Floats) -> Floats:
        """Return which part of the torque there is a motion uses (...): above 1 the loop cannot follow."""
        along = np.where(velocity == 0, np.sign(acceleration), np.sign(velocity))
        needed = self.needed(velocity, acceleration) * along
        most = self.plant.torque_constant * self.plant.amplifier.current
        there = np.where(needed < 0, most, np.minimum(self.available(velocity), most))
        there = np.where(np.isfinite(there), there, np.inf)
        return np.where(there > 0, np.abs(needed) / np.where(there > 0, there, 1.0), np.inf)

    @property
    def greatest_velocity(self) -> float:
        """Joint velocity at which the supply is used up, or that the motor may turn at [mm/s or degree/s]."""
        low, high = 0.0, 1e5
        for _ in range(60):
            middle = 0.5 * (low + high)
            spare = self.available(np.array(middle * self.per_radian)) - self.needed(
                np.array(middle * self.per_radian), np.array(0.0)
            )
            low, high = (middle, high) if float(spare) > 0 else (low, middle)
        return min(low, self.catalogue.greatest_speed) * self.per_radian


def servo_drive(machine: Machine, index: int) -> ServoDrive | None:
    """Return the drive of a joint by its number; None where the file gives no motor, amplifier and loop of a servo."""
    joint = machine.joints[index]
    if not joint.closed:
        return None
    row = machine.kinematics.matrix[index]
    rotary = any(axis.rotary for axis, c in zip(machine.axes, row, strict=True) if c)
    return joint_servo(joint, rotary=rotary, period=machine.servo_period)


def joint_servo(joint: Joint, *, rotary: bool, period: float) -> ServoDrive:
    """Return the drive of a joint in degrees (``rotary``) or mm, with a loop of ``period`` [s] unless it says."""
    catalogue, amplifier, loop = getattr(joint.motor, "catalogue"), joint.amplifier, joint.loop  # noqa: B009
    assert catalogue is not None, "a closed joint has a motor"
    assert amplifier is not None, "a closed joint has an amplifier"
    assert loop is not None, "a closed joint has a loop"
    per_radian = abs(float(joint.transmission.travel_per_turn)) / math.tau
    load = joint.load.at_shaft(abs(joint.transmission.travel_per_turn), rotary=rotary)
    return ServoDrive(
        catalogue=catalogue, amplifier=amplifier, loop=loop,
        plant=_plant(joint, catalogue, amplifier, load, per_radian),
        per_radian=per_radian, friction=catalogue.friction + load.friction,
        play=joint.backlash if joint.train.stiffness is None else 0.0,
        period=loop.period or period,
    )  # fmt: skip


def _plant(
    joint: Joint, catalogue: CatalogueDc | CataloguePmsm, amplifier: ServoAmplifier, load: ShaftLoad, per_radian: float
) -> ServoPlant:
    """Return motor, train and load in SI units of the shaft."""
    train, motor = joint.train, catalogue.parameters()
    behind = load.inertia - joint.load.inertia  # what does not turn with the shaft itself
    split = train.stiffness is not None
    inertia = motor.inertia + joint.load.inertia + (0.0 if split else behind)
    gives = amplifier.physical(catalogue.peak_current or math.inf, inertia=inertia + (behind if split else 0.0),
                               torque_constant=motor.torque_constant)  # fmt: skip
    dry = catalogue.friction + (0.0 if split else load.friction)
    push = 0.0 if gives.mode is Mode.SPEED else amplifier.offset * amplifier.gain * motor.torque_constant
    push /= motor.resistance if gives.mode is Mode.VOLTAGE else 1.0
    own = _friction(train, dry, motor.viscous + (0.0 if split else train.viscous), inertia, loaded=not split)
    far = _friction(train, load.friction, train.viscous, behind, loaded=True) if split else Friction(smooth=SMOOTH)
    encoder = joint.encoder
    return ServoPlant(
        amplifier=gives, resistance=motor.resistance, inductance=motor.inductance,
        torque_constant=motor.torque_constant, emf_constant=motor.emf_constant,
        motor_inertia=inertia, load_inertia=behind if split else 0.0,
        stiffness=train.stiffness, damping=train.damping, gap=joint.backlash / per_radian if split else 0.0,
        motor_friction=own, load_friction=far, load=load.constant - push,
        counts=None if encoder is None else abs(float(joint.counts_per_unit or 0)) * per_radian,
        on_load=encoder is not None and encoder.on_load, edges=None if encoder is None else encoder.edges,
    )  # fmt: skip


def _friction(train: DriveTrain, dry: float, viscous: float, inertia: float, *, loaded: bool) -> Friction:
    """Return the friction of one body, smooth enough for the time step that it is integrated with."""
    stick = train.stick if loaded and train.stick is not None else 0.0
    stribeck = (train.stribeck or 0.0) * math.tau / 60.0 if loaded else 0.0
    smooth = max(SMOOTH, 4.0 * _STEP * max(dry, stick) / inertia)
    return Friction(coulomb=dry, stick=stick, stribeck=stribeck, viscous=viscous, smooth=smooth)
