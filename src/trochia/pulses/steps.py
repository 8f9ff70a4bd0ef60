"""Exact step timing: a trajectory in, each joint's steps out, as whole ticks of a clock.

In: phases of constant jerk over a path, a machine (kinematics, steps a mm or degree), a clock.
Out: ``StepBlock`` after ``StepBlock``: for every joint the tick and the direction of each step.

A step that brings the joint's count to k falls where its position is k steps, whichever way it comes: the count is
always less than one step from the position, equal to it on a whole step, and turning round within a step makes no step
at all.  Every time is found from the trajectory itself, not from the step before, so nothing drifts however long it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from trochia.errors import ConfigError
from trochia.kernels.steps import JointSteps
from trochia.machine.crossing import crossing_of
from trochia.pulses.corrected import CorrectedSteps, CorrectedWay
from trochia.pulses.motor_way import MotorWay, Placed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.toolpath import Toolpath

CLOCK = 16_000_000  #: ticks a second [Hz]: that of the smallest controller board, which divides it no further
WINDOW = 0.1  #: longest block [s]: work enough a call, and a few hundred kB at a hundred thousand steps a second


@runtime_checkable
class Motion(Protocol):
    """What step timing asks of a trajectory."""

    @property
    def path(self) -> Toolpath:
        """The path it runs over, in the machine's axes."""
        ...

    def blocks(self) -> Iterable[NDArray[np.void]]:
        """Give PHASE rows in the order of time, block by block."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class StepBlock:
    """The steps of all joints in a window of time.

    Attributes
    ----------
    start, end
        The window [ticks]; a step belongs to the window its exact time lies in, so a rounded tick may equal ``end``.
    clock
        Ticks a second [Hz].
    counts
        Each joint's position before the window [steps].
    ticks, directions
        For each joint, when each step is (steps,) [ticks], strictly rising, and which way: +1 or -1.
    phases
        The PHASE rows the window belongs to.
    """

    start: int
    end: int
    clock: int
    counts: tuple[int, ...]
    ticks: tuple[NDArray[np.int64], ...]
    directions: tuple[NDArray[np.int8], ...]
    phases: NDArray[np.void]


def step_rows(machine: Machine) -> NDArray[np.float64]:
    """Return steps of each joint a mm or degree of each axis (joints, axes); a servo's row is zero."""
    per_unit = [float(joint.steps_per_unit or 0) for joint in machine.joints]
    return machine.kinematics.matrix * np.array(per_unit)[:, None]


def step_blocks(
    trajectory: Motion, machine: Machine, *, clock: int = CLOCK, counts: tuple[int, ...] | None = None
) -> Iterator[StepBlock]:
    """Yield the steps of every joint of ``machine`` along ``trajectory``, window by window.

    Parameters
    ----------
    trajectory
        Phases and the path they run over.
    machine
        Its kinematics and steppers; a servo joint's arrays are empty.
    clock
        Ticks a second [Hz].
    counts
        Where each joint stands at the start [steps]; None: on the whole step nearest to the path's start.

    Raises
    ------
    ConfigError
        For a clock below one tick a second.
    """
    if clock < 1:
        raise ConfigError(f"a step clock has at least one tick a second, not {clock!r}")
    path, rows = trajectory.path, step_rows(machine)
    begins = np.floor(rows @ path.start + 0.5) if counts is None else counts
    joints: list[JointSteps] | list[CorrectedSteps] = [
        JointSteps(path.segments, path.pool, row, clock, int(begin)) for row, begin in zip(rows, begins, strict=True)
    ]
    if crossing_of(machine) is not None:
        joints = _corrected(trajectory, machine, clock, counts)
    for phases in trajectory.blocks():
        if phases.size:
            yield from _windows(phases, joints, clock)


def _corrected(
    trajectory: Motion, machine: Machine, clock: int, counts: tuple[int, ...] | None
) -> list[CorrectedSteps]:
    """Return the steps of joints whose errors are corrected."""
    if not isinstance(trajectory, Placed):
        raise ConfigError("a motion of a machine whose errors are corrected must say where it is at any time")
    way = MotorWay(machine, trajectory)
    per_unit = np.array([float(joint.steps_per_unit or 0) for joint in machine.joints])
    begins = np.floor(per_unit * way.at(np.zeros(1))[0] + 0.5) if counts is None else np.array(counts)
    shared = CorrectedWay(way)
    return [CorrectedSteps(shared, j, float(scale), clock, int(begins[j])) for j, scale in enumerate(per_unit)]


def _windows(
    phases: NDArray[np.void], joints: list[JointSteps] | list[CorrectedSteps], clock: int
) -> Iterator[StepBlock]:
    """Yield a block of phases cut into windows."""
    for joint in joints:
        joint.load(phases)
    start, end = float(phases["t"][0]), float(phases["t"][-1] + phases["duration"][-1])
    borders = np.linspace(start, end, max(1, int(np.ceil((end - start) / WINDOW))) + 1)
    owners = np.searchsorted(phases["t"], borders, side="right") - 1
    for number in range(1, borders.size):
        counts = tuple(joint.count for joint in joints)
        until = np.inf if number == borders.size - 1 else borders[number] * clock
        steps = [joint.until(until) for joint in joints]
        yield StepBlock(
            start=round(borders[number - 1] * clock),
            end=round(borders[number] * clock),
            clock=clock,
            counts=counts,
            ticks=tuple(ticks for ticks, _ in steps),
            directions=tuple(directions for _, directions in steps),
            phases=phases[owners[number - 1] : owners[number] + 1],
        )
