"""Where a machine's switches really are, for its twin.  In: the machine file.  Out: inputs from real positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine
    from trochia.machine.probe import Part

    Switch = Callable[[NDArray[np.float64]], bool]


def switches_of(machine: Machine) -> dict[str, Switch]:
    """Return whether each switch of an axis and the probe is active, by input, from joint positions (joints,)."""
    inverse = np.asarray(np.linalg.pinv(machine.kinematics.matrix), np.float64)
    found: dict[str, Switch] = {}
    for row, axis in zip(inverse, machine.axes, strict=True):
        for name, at, sign in _of(axis):
            found[name] = _switch(row, at, sign)
    if machine.probe is not None and machine.probe.part is not None:
        found[machine.probe.input] = _touch(machine, inverse, machine.probe.part)
    return found


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
