"""Where a machine's switches really are, for its twin.  In: the machine file.  Out: inputs from real positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.axes import Axis
    from trochia.machine.homing import Homing
    from trochia.machine.machine import Machine
    from trochia.machine.probe import Part

    Switch = Callable[[NDArray[np.float64]], bool]


def switches_of(machine: Machine) -> dict[str, Switch]:
    """Return whether each switch of an axis and the probe is active, by input, from joint positions (joints,)."""
    inverse = np.asarray(np.linalg.pinv(machine.kinematics.matrix), np.float64)
    found: dict[str, Switch] = {}
    for i, (row, axis) in enumerate(zip(inverse, machine.axes, strict=True)):
        for name, at, sign in _of(axis):
            found[name] = _switch(row, at, sign)
        if axis.home is not None and axis.home.second is not None:
            found |= _of_pair(machine, i, axis.home)
    if machine.probe is not None and machine.probe.part is not None:
        found[machine.probe.input] = _touch(machine, inverse, machine.probe.part)
    return found


def _of_pair(machine: Machine, axis: int, home: Homing) -> dict[str, Switch]:
    """Return the home switches of a gantry, each of its own joint."""
    column = machine.kinematics.matrix[:, axis]
    names, shifts = (home.input, home.second), (0.0, home.square)
    _, at, sign = list(_of(machine.axes[axis]))[-1]
    found: dict[str, Switch] = {}
    for joint, name, shift in zip(np.flatnonzero(column), names, shifts, strict=True):
        row = np.zeros(len(column))
        row[joint] = 1.0 / column[joint]
        found[str(name)] = _switch(row, at + shift, sign)
    return found


class Indexes:
    """The index pulses of a machine's encoders: one a turn of the motor, where it reads a whole number of turns."""

    def __init__(self, machine: Machine) -> None:
        self._turns = {
            index_of(joint.name): (i, float(joint.transmission.travel_per_turn))
            for i, joint in enumerate(machine.joints)
            if joint.encoder is not None and joint.encoder.index
        }

    @property
    def names(self) -> tuple[str, ...]:
        """What they are called as inputs."""
        return tuple(self._turns)

    def passed(self, name: str, before: NDArray[np.float64], after: NDArray[np.float64]) -> float | None:
        """Return at which share of the way (joints,) an index pulse came; None: it did not."""
        joint, turn = self._turns[name]
        low, high = before[joint] / turn, after[joint] / turn
        edge = np.floor(max(low, high))
        return float((edge - low) / (high - low)) if min(low, high) < edge else None


def index_of(joint: str) -> str:
    """Return what the index pulse of a joint's encoder is called as an input."""
    return f"{joint}.index"


def crossing(switch: Switch, before: NDArray[np.float64], after: NDArray[np.float64], *, level: bool) -> float:
    """Return at which share of the way (joints,) from one place to another a switch takes a level; it has it there."""
    low, high = 0.0, 1.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        if switch(before + middle * (after - before)) == level:
            high = middle
        else:
            low = middle
    return high if switch(before) != level else 0.0


def _touch(machine: Machine, inverse: NDArray[np.float64], part: Part) -> Switch:
    """Return whether the controlled point is inside a part."""
    sides = {"X": (part.left, part.right), "Y": (part.front, part.back), "Z": (None, part.top)}
    bounds = [sides.get(axis.name, (None, None)) for axis in machine.axes]
    low = np.array([-np.inf if bound[0] is None else bound[0] for bound in bounds])
    high = np.array([np.inf if bound[1] is None else bound[1] for bound in bounds])

    def touches(joints: NDArray[np.float64]) -> bool:
        place = inverse @ joints
        return bool(np.all((place >= low) & (place <= high)))

    return touches


def _of(axis: Axis) -> Iterator[tuple[str, float, float]]:
    """Yield name, place and direction of an axis' switches."""
    if axis.limit_minus is not None:
        yield axis.limit_minus.input, axis.limit_minus.at, -1.0
    if axis.limit_plus is not None:
        yield axis.limit_plus.input, axis.limit_plus.at, 1.0
    home = axis.home
    if home is not None and home.input is not None:
        sign = 1.0 if home.towards == "+" else -1.0
        end = axis.maximum if sign > 0.0 else axis.minimum
        yield home.input, end if home.position is None else home.position, sign


def _switch(row: NDArray[np.float64], at: float, sign: float) -> Switch:
    return lambda joints: bool(sign * (float(row @ joints) - at) >= 0.0)
