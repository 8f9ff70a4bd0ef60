"""What binds a path.  In: a Machine.  Out: rows of limited quantities q = C x, and caps on the vector.

The axes come first (C begins with the unit matrix); then the joints that carry limits of their own, through the
kinematic matrix.  Joints that move alike share a row, with the least of their limits.  Legend: C rows over axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Rows of limits over the axes, and caps.

    Attributes
    ----------
    names
        Of each row, as a user knows it: ``axis X``, ``joint left``.
    matrix
        C (rows, axes), the unit matrix first.
    velocity, acceleration, jerk
        Of each row (rows,) [mm/s … or degree/s …]; infinite where nothing is given.
    path_velocity, path_acceleration, path_jerk
        Caps on the vector X Y Z; infinite where nothing is given.
    linear
        Number of leading axes that are X, Y or Z.
    """

    names: tuple[str, ...]
    matrix: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    jerk: NDArray[np.float64]
    path_velocity: float
    path_acceleration: float
    path_jerk: float
    linear: int

    @classmethod
    def of(cls, machine: Machine) -> Limits:
        """Return the limits of a machine."""
        rows = {_key(row): _Row(f"axis {a.name}", a.velocity, a.acceleration, _or_inf(a.jerk))
                for row, a in zip(np.eye(len(machine.axes)), machine.axes, strict=True)}  # fmt: skip
        for joint, row in zip(machine.joints, machine.kinematics.matrix, strict=True):
            own = _Row(f"joint {joint.name}", *map(_or_inf, (joint.velocity, joint.acceleration, joint.jerk)))
            if own[1:] != (math.inf, math.inf, math.inf):
                rows[_key(row)] = own.tighten(rows.get(_key(row)))
        return cls(
            names=tuple(row.name for row in rows.values()),
            matrix=np.array(list(rows), dtype=np.float64),
            velocity=np.array([row.velocity for row in rows.values()]),
            acceleration=np.array([row.acceleration for row in rows.values()]),
            jerk=np.array([row.jerk for row in rows.values()]),
            path_velocity=_or_inf(machine.path.velocity),
            path_acceleration=_or_inf(machine.path.acceleration),
            path_jerk=_or_inf(machine.path.jerk),
            linear=sum(axis.name in "XYZ" for axis in machine.axes),
        )


class _Row(NamedTuple):
    """One limited quantity before it is a row of arrays."""

    name: str
    velocity: float
    acceleration: float
    jerk: float

    def tighten(self, other: _Row | None) -> _Row:
        """Return the least of both under the name of the first that is below the other."""
        if other is None:
            return self
        binds = any(mine < theirs for mine, theirs in zip(self[1:], other[1:], strict=True))
        return _Row(self.name if binds else other.name, *map(min, self[1:], other[1:]))


def _key(row: NDArray[np.float64]) -> tuple[float, ...]:
    """Return a row of C as a key: the same quantity whichever way the joint counts."""
    leading = next((c for c in row if c != 0.0), 1.0)
    return tuple(float(c) + 0.0 for c in (row if leading > 0 else -row))


def _or_inf(value: float | None) -> float:
    return math.inf if value is None else value
