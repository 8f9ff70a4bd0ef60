"""Kinematics: axes to joints.  The linear ones are a matrix: joints = matrix @ axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Protocol, Self

import numpy as np

from trochia.errors import ConfigError
from trochia.units import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray


class Kinematics(Protocol):
    """Axis positions to joint positions and back; arrays are (..., n)."""

    kind: ClassVar[str]

    @classmethod
    def fit(cls, axes: tuple[str, ...], joints: Mapping[str, str | None]) -> Self:
        """Return the kinematics of these axes and joints.

        Parameters
        ----------
        axes
            Letters, in the machine's order.
        joints
            Name of each joint in the file's order, with the axis it says it drives (None: not said).

        Raises
        ------
        ConfigError
            When they do not fit; its key names the joint or axis.
        """
        ...

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

    @classmethod
    def fit(cls, axes: tuple[str, ...], joints: Mapping[str, str | None]) -> Self:
        """Return the kinematics; a joint drives the axis it names, or the one it is named after."""
        return cls(_driven(axes, joints), len(axes))

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Rows of the unit matrix."""
        return np.eye(self.count)[list(self.axes)]


@dataclass(frozen=True, slots=True)
class CoreXY:
    """Two belts: the first joint moves with X + Y, the second with X - Y; further joints are one an axis."""

    kind: ClassVar[str] = "corexy"
    count: int  #: number of axes
    rest: tuple[int, ...] | None = None  #: columns of the further joints; None: one each, in order

    @classmethod
    def fit(cls, axes: tuple[str, ...], joints: Mapping[str, str | None]) -> Self:
        """Return the kinematics; the first two joints in the file are the belts."""
        if axes[:2] != ("X", "Y"):
            raise ConfigError("corexy kinematics needs the axes X and Y", key="axes")
        belts, rest = list(joints)[:2], list(joints)[2:]
        if len(belts) < 2:
            raise ConfigError("corexy kinematics needs two joints for its belts, before all others", key="joints")
        for name in belts:
            if joints[name] is not None:
                raise ConfigError("the first two joints of corexy move X and Y together: leave axis out",
                                  key=f"joints.{name}.axis")  # fmt: skip
        columns = _driven(axes, {name: joints[name] for name in rest})
        return cls(len(axes), None if columns == tuple(range(2, len(axes))) else columns)

    @property
    def matrix(self) -> NDArray[np.float64]:
        """The belts' rows, then rows of the unit matrix."""
        rest = range(2, self.count) if self.rest is None else self.rest
        belts = np.zeros((2, self.count))
        belts[:, :2] = [[1.0, 1.0], [1.0, -1.0]]
        return np.concatenate([belts, np.eye(self.count)[list(rest)]])


@dataclass(frozen=True, slots=True)
class Lathe(Cartesian):
    """Cartesian in X (radius) and Z with the spindle as master."""

    kind: ClassVar[str] = "lathe"

    @classmethod
    def fit(cls, axes: tuple[str, ...], joints: Mapping[str, str | None]) -> Self:
        """Return the kinematics; a lathe has at least X and Z."""
        for letter in "XZ":
            if letter not in axes:
                raise ConfigError(f"lathe kinematics needs the axis {letter}", key="axes")
        return cls(_driven(axes, joints), len(axes))


def _driven(axes: tuple[str, ...], joints: Mapping[str, str | None]) -> tuple[int, ...]:
    """Return the column of the one axis that each joint drives."""
    columns: list[int] = []
    for name, said in joints.items():
        axis = name if said is None else said
        if axis not in axes:
            known = f"this machine has {' '.join(axes)}"
            if said is None:
                raise ConfigError(f"missing: the joint is named after no axis ({known})", key=f"joints.{name}.axis")
            raise ConfigError(f"expected an axis of the machine, not {said!r} ({known})", key=f"joints.{name}.axis",
                              hint=did_you_mean(said, axes))  # fmt: skip
        columns.append(axes.index(axis))
    return tuple(columns)


KINEMATICS: dict[str, type[Kinematics]] = {k.kind: k for k in (Cartesian, CoreXY, Lathe)}
