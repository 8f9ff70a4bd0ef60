"""What binds a path.  In: a Machine.  Out: rows of limited quantities q = C x, and caps on the vector.

The axes come first (C begins with the unit matrix); then the joints that carry limits of their own, through the
kinematic matrix.  Legend: C rows over axes, V and A limits of q' and q'' in time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

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
        axes = [(f"axis {a.name}", a.velocity, a.acceleration, _or_inf(a.jerk)) for a in machine.axes]
        rows = list(np.eye(len(axes)))
        for joint, row in zip(machine.joints, machine.kinematics.matrix, strict=True):
            if joint.velocity is not None or joint.acceleration is not None or joint.jerk is not None:
                own = (_or_inf(joint.velocity), _or_inf(joint.acceleration), _or_inf(joint.jerk))
                axes.append((f"joint {joint.name}", *own))
                rows.append(row)
        return cls(
            names=tuple(name for name, *_ in axes),
            matrix=np.array(rows, dtype=np.float64),
            velocity=np.array([row[1] for row in axes]),
            acceleration=np.array([row[2] for row in axes]),
            jerk=np.array([row[3] for row in axes]),
            path_velocity=_or_inf(machine.path.velocity),
            path_acceleration=_or_inf(machine.path.acceleration),
            path_jerk=_or_inf(machine.path.jerk),
            linear=sum(axis.name in "XYZ" for axis in machine.axes),
        )


def _or_inf(value: float | None) -> float:
    return math.inf if value is None else value
