"""The steppers of a machine as physics, at the end of the step pulses that a motion makes.

In: a motion with its step pulses, the joints whose file names motor, driver and load.  Out: block by block where each
rotor is, its load angle, and the steps it has lost.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.stepper_twin import Levels, StepperTwin, longest_step
from trochia.kernels.twin import TwinBlock, TwinJoint
from trochia.machine.torque import drive
from trochia.planner import Trajectory
from trochia.planner.timed import fitted
from trochia.pulses.steps import step_blocks

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.machine.torque import Drive
    from trochia.pulses.steps import Motion, StepBlock

SETTLING = 0.2  #: at standstill before the motion, for the phases to draw the rotor in [s]
LOOK = 1e-3  #: the load angle is looked at as often [s]
LEVELS = Levels(window=20e-3)


class PhysicalJoint:
    """One stepper behind its driver, and what follows it.

    Parameters
    ----------
    period
        Between samples [s].
    count
        Step count at the start.
    slack
        Where the load lies in its backlash, as :class:`TwinJoint`.
    """

    def __init__(self, joint: Joint, motor: Drive, *, period: float, count: int, slack: float) -> None:
        steps = joint.steps_per_unit
        assert steps is not None, "a joint with a stepper's driver has steps"
        self._per_unit, self._begin = float(steps), count
        looks = math.ceil(period / LOOK)
        self._every = math.ceil(period / looks / longest_step(motor.made, motor.load))
        self._looks, self._tick = looks, period / looks / self._every
        self._stepper = StepperTwin(motor.made, motor.load, levels=LEVELS, step=self._tick)
        self._stepper.run_ticks(round(SETTLING / self._tick))
        self._zero = self._stepper.now + period  # the first sample stands a period on
        self._first = self._angle_of_rest()
        self._counts = None if joint.counts_per_unit is None else float(joint.counts_per_unit)
        self._on_load = joint.encoder is not None and joint.encoder.on_load
        self._play = TwinJoint(count / self._per_unit, name=joint.name, backlash=joint.backlash, slack=slack)
        self._times: list[NDArray[np.float64]] = []
        self._signs: list[NDArray[np.int8]] = []

    def _angle_of_rest(self) -> float:
        """Return the electrical angle of the field at the first row."""
        return self._stepper.made.excitation.first_angle

    def queue(self, times: NDArray[np.float64], directions: NDArray[np.int8]) -> None:
        """Take step pulses [s from the motion's start] (pulses,), to be played with the next :meth:`run`."""
        self._times.append(times)
        self._signs.append(directions)

    def run(self, samples: int) -> TwinBlock:
        """Return the next samples, a period apart; the first ever is the motion's start."""
        times = np.concatenate([np.empty(0), *self._times]) + self._zero
        self._stepper.queue(times, np.concatenate([np.empty(0, np.int8), *self._signs]))
        self._times, self._signs = [], []
        run = self._stepper.run_ticks(samples * self._looks * self._every, every=self._every)
        keep = slice(self._looks - 1, None, self._looks)
        made = self._stepper.made
        turned = made.motor.teeth * run.theta[keep] - self._first
        travel = (self._begin + turned / made.excitation.step_angle) / self._per_unit
        followed = self._play.run(travel)
        read = followed.load if self._on_load else travel
        return replace(
            followed,
            position=self._begin + run.position[keep],
            counts=None if self._counts is None else np.floor(read * self._counts + 1e-6).astype(np.int64),
            load_angle=np.degrees(run.load_angle[keep]),
            lost=run.lost_steps[keep],
            current=np.hypot(*run.currents[keep].T),
        )

    @property
    def switched(self) -> float:
        """Time that was done switch by switch [s]."""
        return self._stepper.switched


@dataclass(slots=True)
class PhysicalJoints:
    """The physical joints of a machine under one motion, by number."""

    joints: dict[int, PhysicalJoint]
    _steps: Iterator[StepBlock]
    _reached: float = 0.0

    @classmethod
    def of(cls, machine: Machine, motion: Motion, *, period: float, slack: float) -> PhysicalJoints:
        """Return them at rest at the motion's start."""
        steps = step_blocks(fitted(motion, machine) if isinstance(motion, Trajectory) else motion, machine)
        first = next(steps, None)
        start = machine.kinematics.matrix @ motion.path.start
        joints: dict[int, PhysicalJoint] = {}
        for i, joint in enumerate(machine.joints):
            motor = drive(machine, i)
            if motor is not None:
                at = round(start[i] * float(joint.steps_per_unit or 0)) if first is None else first.counts[i]
                joints[i] = PhysicalJoint(joint, motor, period=period, count=at, slack=slack)
        made = cls(joints, steps)
        if first is not None:
            made._take(first)
        return made

    def feed(self, until: float) -> None:
        """Hand on the step pulses up to a time of the motion [s]."""
        while self._reached <= until:
            block = next(self._steps, None)
            if block is None:
                self._reached = math.inf
            else:
                self._take(block)

    def _take(self, block: StepBlock) -> None:
        for i, joint in self.joints.items():
            joint.queue(block.ticks[i] / block.clock, block.directions[i])
        self._reached = block.end / block.clock
