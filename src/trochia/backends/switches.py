"""Where a machine's switches really are, for its twin.  In: the machine file.  Out: inputs from real positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine

    Switch = Callable[[NDArray[np.float64]], bool]


def switches_of(machine: Machine) -> dict[str, Switch]:
    """Return whether each limit and home switch is active, by its input's name, from joint positions (joints,)."""
    inverse = np.linalg.pinv(machine.kinematics.matrix)
    found: dict[str, Switch] = {}
    for row, axis in zip(inverse, machine.axes, strict=True):
        for name, at, sign in _of(axis):
            found[name] = _switch(row, at, sign)
    return found


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
