"""What the twin records: one row a quantity, of every axis, of every joint, or of the path.

In: a machine.  Out: the channels of its recordings, each with what takes its samples from a block of motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.machine.axes import AxisKind
from trochia.recorder import Channel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.backends.protocol import Motion
    from trochia.kernels.twin import TwinBlock
    from trochia.machine.joints import Joint
    from trochia.machine.machine import Machine
    from trochia.recorder.channel import Scalar

    Taker = Callable[["Sampled"], NDArray[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampled:
    """A block of motion on the twin: times (samples,) [s], axes (samples, axes) [mm or degree], joints in order."""

    t: NDArray[np.float64]
    motion: Motion
    commanded: NDArray[np.float64]
    actual: NDArray[np.float64]
    joints: list[TwinBlock]


@dataclass(frozen=True, slots=True)
class AxisSignal:
    """A quantity of every axis, in the axis' unit; ``take`` gives (samples, axes)."""

    quantity: str
    take: Callable[[Sampled], NDArray[Any]]


@dataclass(frozen=True, slots=True)
class JointSignal:
    """A quantity of every joint that has it; unit None is the joint's own."""

    quantity: str
    take: Callable[[TwinBlock], NDArray[Any] | None]
    unit: str | None = None
    dtype: Scalar = "<f8"
    of: Callable[[Joint], bool] = lambda _: True


@dataclass(frozen=True, slots=True)
class PathSignal:
    """A quantity of the motion as a whole, on machines that have it."""

    name: str
    take: Taker
    unit: str = ""
    dtype: Scalar = "<f8"
    of: Callable[[Machine], bool] = lambda _: True


AXIS = (
    AxisSignal("commanded", lambda block: block.commanded),
    AxisSignal("actual", lambda block: block.actual),
)
JOINT = (
    JointSignal("steps", lambda joint: joint.position, "step", "<i8", lambda joint: joint.steps_per_unit is not None),
    JointSignal("motor", lambda joint: joint.motor),
    JointSignal("counts", lambda joint: joint.counts, "count", "<i8", lambda joint: joint.encoder is not None),
    JointSignal("actual", lambda joint: joint.load),
)
PHYSICAL = (
    JointSignal("load_angle", lambda joint: joint.load_angle, "degree", of=lambda joint: joint.fed is not None),
    JointSignal("lost_steps", lambda joint: joint.lost, "step", "<i8", lambda joint: joint.fed is not None),
    JointSignal("current", lambda joint: joint.current, "A", of=lambda joint: joint.fed is not None),
)
CLOSED = (
    JointSignal("measured", lambda joint: joint.measured, of=lambda joint: joint.closed),
    JointSignal("command", lambda joint: joint.command, "V", of=lambda joint: joint.closed),
    JointSignal("current", lambda joint: joint.current, "A", of=lambda joint: joint.closed),
    JointSignal("torque", lambda joint: joint.torque, "N·m", of=lambda joint: joint.closed),
)
PATH = (
    PathSignal("path.speed", lambda block: block.motion.path_speed(block.t), "mm/s"),
    PathSignal("path.line", lambda block: np.asarray(block.motion.line_at(block.t), np.uint32), dtype="<u4"),
    PathSignal("beam", lambda block: block.motion.power_at(block.t), dtype="<f4", of=lambda m: m.beam is not None),
)


def signals(machine: Machine, *, physical: bool = False, closed: bool = False) -> Iterator[tuple[Channel, Taker]]:
    """Yield every channel of a machine's recordings and what takes its samples, in the order of the file.

    ``physical`` adds those of steppers as physics, ``closed`` those of servos as physics.
    """
    units = ["mm" if axis.kind is AxisKind.LINEAR else "degree" for axis in machine.axes]
    for signal in AXIS:
        for i, axis in enumerate(machine.axes):
            yield Channel(name=f"{axis.name}.{signal.quantity}", unit=units[i]), _column(signal, i)
    for i, (joint, row) in enumerate(zip(machine.joints, machine.kinematics.matrix, strict=True)):
        own = units[int(np.argmax(np.abs(row)))]
        for signal in (*JOINT, *(PHYSICAL if physical else ()), *(CLOSED if closed else ())):
            if signal.of(joint):
                unit = own if signal.unit is None else signal.unit
                channel = Channel(name=f"joint.{joint.name}.{signal.quantity}", unit=unit, dtype=signal.dtype)
                yield channel, _joint(signal, i)
    for signal in PATH:
        if signal.of(machine):
            yield Channel(name=signal.name, unit=signal.unit, dtype=signal.dtype), signal.take


def _column(signal: AxisSignal, i: int) -> Taker:
    return lambda block: signal.take(block)[:, i]


def _joint(signal: JointSignal, i: int) -> Taker:
    def take(block: Sampled) -> NDArray[Any]:
        samples = signal.take(block.joints[i])
        assert samples is not None, f"{signal.quantity} is recorded of joints that have it"
        return samples

    return take
