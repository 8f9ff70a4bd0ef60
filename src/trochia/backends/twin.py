"""The digital twin: motors, transmissions with backlash, encoders, on a clock of its own.

In: a motion and a machine.  Out: blocks of three independent signals, the commanded position, what the encoders count,
and where the axes really are; ``signals.py`` has a row for each channel.

``axes --kinematics, corrections--> joint command --motor--> motor --backlash--> load --errors, inverse--> axes``

An ideal stepper stands on the last step passed, an ideal servo on the nearest count of its encoder (on the load as on
the motor: no loop is closed here); neither is late or loses anything, so what is left is resolution and lost motion.
A stepper whose file names motor, driver and load is physics, where the motion has step pulses: it lags, swings and
loses steps (``physical.py``).  A servo whose file names motor, amplifier and loop is physics too: it follows as its
loop lets it (``closed.py``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from trochia.backends.closed import ClosedJoints
from trochia.backends.errors import with_errors
from trochia.backends.physical import PhysicalJoints
from trochia.backends.signals import Sampled, signals
from trochia.errors import ConfigError
from trochia.kernels.twin import TwinJoint
from trochia.pulses.motor_way import MotorWay
from trochia.pulses.steps import Motion as Stepped
from trochia.recorder import Channel, Header

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from trochia.backends.protocol import Motion
    from trochia.backends.signals import Taker
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine

BLOCK = 65_536  #: samples at a time: a few MB, and some milliseconds of work a call


@dataclass(frozen=True, slots=True, kw_only=True)
class Twin:
    """A machine.

    Attributes
    ----------
    machine
        What is to be moved.
    period
        Time between samples [s]; the machine's servo period where None.
    slack
        Where every load lies in its backlash at the start, -1 to 1: 0 centred, -1 as after moving forwards.
    physical
        Whether joints are physics where the machine's file allows it; without it all are ideal.
    """

    kind: ClassVar[str] = "twin"
    machine: Machine
    period: float | None = None
    slack: float = 0.0
    physical: bool = True

    def __post_init__(self) -> None:
        if not (math.isfinite(self.tick) and self.tick > 0):
            raise ConfigError(f"a twin's period must be above zero, not {self.tick!r} s")
        if not -1 <= self.slack <= 1:
            raise ConfigError(f"a twin's slack lies within -1 to 1, not {self.slack!r}")

    @property
    def tick(self) -> float:
        """Time between samples [s]."""
        return self.machine.servo_period if self.period is None else self.period

    def header(self, motion: Motion, *, program: str = "") -> Header:
        """Return the header of the recording that :meth:`run` gives the samples of."""
        return Header(
            period=self.tick,
            duration=motion.duration,
            machine=self.machine.name,
            program=program,
            origin=f"twin of {'physical' if self._physical(motion) or self._closed else 'ideal'} joints, "
            f"slack {self.slack:g}",
            channels=tuple(channel for channel, _ in self._signals(motion)),
        )

    def run(self, motion: Motion) -> Iterator[Mapping[str, NDArray[Any]]]:
        """Yield the motion's samples at 0, 1, 2, … periods, up to the first at or after its end (there: the end)."""
        matrix = self.machine.kinematics.matrix
        inverse = np.linalg.pinv(matrix)
        start = MotorWay(self.machine, motion).at(np.zeros(1))[0]
        joints = [self._joint(joint, at) for joint, at in zip(self.machine.joints, start, strict=True)]
        way = MotorWay(self.machine, motion)
        recorded = self._signals(motion)
        real = self._steppers(motion)
        closed = ClosedJoints.of(self.machine, motion, slack=self.slack) if self._closed else None
        # a millionth of a period: a duration is a sum, and rounding must not buy it one more sample
        samples = math.ceil(motion.duration / self.tick - 1e-6) + 1
        for first in range(0, samples, BLOCK):
            t = self.tick * np.arange(first, min(first + BLOCK, samples), dtype=np.float64)
            if first + BLOCK >= samples:
                t[-1] = motion.duration
            commanded = motion.position(t)
            wanted = way.at(t)
            if real is not None:
                real.feed(float(t[-1]) + self.tick)
            if closed is not None:
                closed.feed(float(t[-1]))
            done = [
                real.joints[i].run(t.size) if real is not None and i in real.joints
                else closed.joints[i].sample(t) if closed is not None and i in closed.joints
                else joint.run(wanted[:, i])
                for i, joint in enumerate(joints)
            ]  # fmt: skip
            loads = np.stack([block.load for block in done], axis=1)
            erring = with_errors(self.machine, loads)
            if erring is not loads:
                done = [replace(block, load=erring[:, i]) for i, block in enumerate(done)]
            actual = erring @ inverse.T
            block = Sampled(t=t, motion=motion, commanded=commanded, actual=actual, joints=done)
            yield {channel.name: take(block) for channel, take in recorded}

    def _physical(self, motion: Motion) -> bool:
        """Whether some joint is physics under this motion."""
        return self.physical and isinstance(motion, Stepped) and any(j.fed is not None for j in self.machine.joints)

    @property
    def _closed(self) -> bool:
        """Whether some servo is physics."""
        return self.physical and any(joint.closed for joint in self.machine.joints)

    def _signals(self, motion: Motion) -> list[tuple[Channel, Taker]]:
        """Return the channels of a recording and what takes their samples."""
        return list(signals(self.machine, physical=self._physical(motion), closed=self._closed))

    def _steppers(self, motion: Motion) -> PhysicalJoints | None:
        """Return the physical joints, or None where there are none."""
        if not self._physical(motion) or not isinstance(motion, Stepped):
            return None
        return PhysicalJoints.of(self.machine, motion, period=self.tick, slack=self.slack)

    def _joint(self, joint: Joint, command: float) -> TwinJoint:
        return TwinJoint(
            command,
            name=joint.name,
            steps_per_unit=joint.steps_per_unit,
            counts_per_unit=joint.counts_per_unit,
            on_load=joint.encoder is not None and joint.encoder.on_load,
            backlash=joint.backlash,
            slack=self.slack,
        )
