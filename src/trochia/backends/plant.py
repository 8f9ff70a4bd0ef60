"""What is really there, joint by joint: the plant of the live twin.

In: joint positions as commanded.  Out: where motors and loads really are.  Positions are real ones: what a controller
calls them may be off by anything until it has homed.

A servo whose file names motor, amplifier and loop is physics; every other joint is ideal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.errors import with_errors
from trochia.backends.live_servo import LiveServo
from trochia.kernels.twin import TwinJoint
from trochia.machine.servos.drive import servo_drive

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine


class Plant:
    """Motors, transmissions with backlash, encoders.

    Parameters
    ----------
    position
        Where the joints are (joints,) [mm or degree].

    Attributes
    ----------
    motor, load
        Where they are (joints,).
    lag
        Greatest distance of what tells the position from the command over the last block (joints,): of a servo that is
        physics its encoder, else the load.
    loads, measured
        Where loads were and what encoders said at each tick of the last block (ticks, joints); NaN without encoder.
    jammed
        Names of joints whose load and motor stay where they are, whatever is commanded.
    """

    def __init__(self, machine: Machine, position: NDArray[np.float64]) -> None:
        self._machine = machine
        self._joints = [
            TwinJoint(
                float(at), name=joint.name, steps_per_unit=joint.steps_per_unit, counts_per_unit=joint.counts_per_unit,
                on_load=joint.encoder is not None and joint.encoder.on_load, backlash=joint.backlash,
            )
            for at, joint in zip(position, machine.joints, strict=True)
        ]  # fmt: skip
        drives = (servo_drive(machine, i) for i in range(len(machine.joints)))
        self._servos = {
            i: LiveServo(machine.joints[i], drive, position=float(position[i]), tick=machine.servo_period)
            for i, drive in enumerate(drives)
            if drive is not None
        }
        self.motor, self.load = position.copy(), position.copy()
        self.lag = np.zeros(len(position))
        self.loads, self.measured = self.load[None, :], self.encoder()[None, :]
        self.jammed: set[str] = set()

    def follow(self, commanded: NDArray[np.float64]) -> NDArray[np.float64]:
        """Follow a block of commands (ticks, joints); return where the loads were (ticks, joints)."""
        loads = np.tile(self.load, (len(commanded), 1))
        self.measured = np.tile(self.encoder(), (len(commanded), 1))
        for i, joint in enumerate(self._joints):
            servo = self._servos.get(i)
            if self._machine.joints[i].name in self.jammed:
                self.lag[i] = abs(commanded[-1, i] - self.load[i])
            elif servo is not None:
                motor, loads[:, i] = servo.follow(commanded[:, i])
                self.motor[i], self.load[i], self.lag[i] = motor[-1], loads[-1, i], servo.lag
                if self._machine.joints[i].encoder is not None:
                    self.measured[:, i] = servo.readings
            else:
                block = joint.run(commanded[:, i])
                loads[:, i] = block.load
                self.motor[i], self.load[i] = block.motor[-1], block.load[-1]
                encoder = self._machine.joints[i].encoder
                if encoder is not None:
                    self.measured[:, i] = block.load if encoder.on_load else block.motor
                self.lag[i] = abs(commanded[-1, i] - self.load[i])
        self.loads = loads
        return loads

    def real(self, loads: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where loads really are (ticks, joints): with the errors of screws and of axes that are not square."""
        return with_errors(self._machine, loads)

    @property
    def restless(self) -> bool:
        """Whether a servo may still be moving though its command rests."""
        return any(servo.restless for servo in self._servos.values())

    def rejoin(self, commanded: NDArray[np.float64]) -> NDArray[np.float64]:
        """Close the servos' loops anew where their motors are; return the commands that are true then (joints,)."""
        true = commanded.copy()
        for i, servo in self._servos.items():
            true[i] = self.motor[i]
            servo.rejoin(float(true[i]))
        return true

    def encoder(self) -> NDArray[np.float64]:
        """Return what the encoders say (joints,); NaN where there is none."""
        read = np.full(len(self._joints), np.nan)
        for i, joint in enumerate(self._machine.joints):
            if i in self._servos and joint.encoder is not None:
                read[i] = self._servos[i].measured
            elif joint.encoder is not None:
                read[i] = self.load[i] if joint.encoder.on_load else self.motor[i]
        return read
