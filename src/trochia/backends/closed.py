"""The servo joints of a machine as physics: their loops follow a motion tick by tick.

In: a motion, the joints whose file says all of their loop.  Out: block by block where each motor and load is, what its
encoder says, and what its loop commands.

A loop runs at its own period; samples between its ticks are in between (positions) or held (all else).  Velocity and
acceleration wanted are differences of the positions wanted a tick before and after: a plan is known ahead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.twin import TwinBlock, TwinJoint
from trochia.machine.servos.drive import servo_drive
from trochia.pulses.motor_way import MotorWay
from trochia.servo.joint import JointServo, at_rest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.backends.protocol import Motion
    from trochia.kernels.servo import ServoSamples
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.machine.servos.drive import ServoDrive

SETTLING = 0.2  #: at standstill before the motion, for the loop to carry what hangs on it [s]


class ClosedJoint:
    """One servo and its loop, settled at ``position``, and what follows it.

    Parameters
    ----------
    slack
        Where the load lies in its backlash, as :class:`TwinJoint`.
    """

    def __init__(self, joint: Joint, drive: ServoDrive, *, position: float, slack: float = 0.0) -> None:
        self.drive, self.joint = drive, joint
        self._servo = JointServo(drive, position=position, name=joint.name)
        self._servo.run(at_rest(position, math.ceil(SETTLING / drive.period)))
        self._play = TwinJoint(position, name=joint.name, backlash=drive.play, slack=slack)
        self._ticks = np.empty(0, np.int64)
        self._rows = np.empty((6, 0))

    def follow(self, first: int, wanted: NDArray[np.float64]) -> None:
        """Run through ticks from number ``first`` on, following (ticks, 3) [mm or degree]."""
        rows = self._servo.run(wanted)
        self._ticks = np.concatenate([self._ticks, first + np.arange(len(wanted))])
        self._rows = np.concatenate([self._rows, _columns(rows)], axis=1)

    def sample(self, t: NDArray[np.float64]) -> TwinBlock:
        """Return what was at times (samples,) [s], rising, of ticks run through; earlier ticks are forgotten."""
        at = t / self.drive.period
        held = np.clip(np.floor(at + 1e-6).astype(np.int64) - self._ticks[0], 0, len(self._ticks) - 1)
        motor, load = (np.interp(at, self._ticks, self._rows[i]) for i in (0, 1))
        measured, command, current, torque = (self._rows[i, held] for i in range(2, 6))
        keep = int(held[-1])
        self._ticks, self._rows = self._ticks[keep:], self._rows[:, keep:]
        counts = self.joint.counts_per_unit
        followed = self._play.run(load)
        return replace(
            followed,
            motor=motor,
            counts=None if counts is None else np.rint(measured * float(counts)).astype(np.int64),
            measured=measured,
            command=command,
            current=current,
            torque=torque,
        )


def _columns(rows: ServoSamples) -> NDArray[np.float64]:
    return np.stack([rows.motor, rows.load, rows.measured, rows.command, rows.current, rows.force])


@dataclass(slots=True)
class ClosedJoints:
    """The servo joints of a machine under one motion, by number."""

    machine: Machine
    motion: Motion
    joints: dict[int, ClosedJoint]
    _done: dict[float, int] = field(default_factory=dict[float, int])
    _ways: dict[float, MotorWay] = field(default_factory=dict[float, MotorWay])

    @classmethod
    def of(cls, machine: Machine, motion: Motion, *, slack: float) -> ClosedJoints:
        """Return them settled at the motion's start."""
        start = MotorWay(machine, motion).at(np.zeros(1))[0]
        joints: dict[int, ClosedJoint] = {}
        for i, joint in enumerate(machine.joints):
            drive = servo_drive(machine, i)
            if drive is not None:
                joints[i] = ClosedJoint(joint, drive, position=float(start[i]), slack=slack)
        return cls(machine, motion, joints)

    def feed(self, until: float) -> None:
        """Run all loops up to a time of the motion [s], and one tick beyond."""
        for period in {joint.drive.period for joint in self.joints.values()}:
            first = self._done.get(period, 0)
            last = math.ceil(until / period) + 2
            if last <= first:
                continue
            way = self._ways.setdefault(period, MotorWay(self.machine, self.motion))
            ticks = period * np.arange(first - 1, last + 1, dtype=np.float64)
            places = way.at(ticks)
            for i, joint in self.joints.items():
                if joint.drive.period == period:
                    joint.follow(first, differences(places[:, i], period))
            self._done[period] = last


def differences(places: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """Return position, velocity and acceleration (ticks, 3) of places (ticks + 2,), one before and one after."""
    before, now, after = places[:-2], places[1:-1], places[2:]
    return np.stack([now, (after - before) / (2 * period), (after - 2 * now + before) / period**2], axis=1)
