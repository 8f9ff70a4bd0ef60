"""Kinematics: axes to joints.  The linear ones are a matrix: joints = matrix @ axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Kinematics(Protocol):
    """Axis positions to joint positions and back; arrays are (..., n)."""

    kind: ClassVar[str]

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Joint positions a unit of each axis (joints, axes)."""
        ...


@dataclass(frozen=True, slots=True)
class Cartesian:
    """One joint an axis, in the same order; a gantry's second joint repeats its axis' row."""

    kind: ClassVar[str] = "cartesian"
    axes: tuple[int, ...]  #: for each joint, the column of its axis
    count: int  #: number of axes

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Rows of the unit matrix."""
        return np.eye(self.count)[list(self.axes)]


@dataclass(frozen=True, slots=True)
class CoreXY:
    """Two belts: the first joint moves with X + Y, the second with X - Y; further joints are one an axis."""

    kind: ClassVar[str] = "corexy"
    count: int

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Unit matrix with the belts' block at its start."""
        matrix = np.eye(self.count)
        matrix[:2, :2] = [[1.0, 1.0], [1.0, -1.0]]
        return matrix


@dataclass(frozen=True, slots=True)
class Lathe(Cartesian):
    """Cartesian in X (radius) and Z with the spindle as master."""

    kind: ClassVar[str] = "lathe"


KINEMATICS: dict[str, type[Kinematics]] = {k.kind: k for k in (Cartesian, CoreXY, Lathe)}
