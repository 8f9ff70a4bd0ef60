"""What binds a path.  In: a Machine.  Out: rows of limited quantities q = C x, and caps on the vector.

The axes come first (C begins with the unit matrix); then the joints that carry limits of their own, through the
kinematic matrix.  Joints that move alike share a row, with the least of their limits.  Legend: C rows over axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.acceleration import AccelerationCurve
from trochia.machine.crossing import crossing_of
from trochia.machine.rates import joint_velocity
from trochia.machine.reserve import shares
from trochia.machine.torque import drive

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine

_REACHED = 0.98  #: of the speed at which a motor has nothing left to accelerate with


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
    curves
        Of rows whose acceleration falls with speed, by row; ``acceleration`` then holds the least of it.
    segment_time
        Least time of a segment [s]; 0 where there is none.
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
    curves: Mapping[int, AccelerationCurve] = field(default_factory=dict[int, AccelerationCurve])
    segment_time: float = 0.0

    def acceleration_at(self, speed: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the greatest acceleration of each row at its |speed| (n, rows)."""
        bounds = np.broadcast_to(self.acceleration, speed.shape).copy()
        for row, curve in self.curves.items():
            bounds[:, row] = curve.at(speed[:, row])
        return bounds

    @classmethod
    def of(cls, machine: Machine, *, motors: bool = False) -> Limits:
        """Return the limits of a machine.

        Parameters
        ----------
        motors
            Joints whose file names motor, driver and load are held to what these can give at their speed too.

        Raises
        ------
        ConfigError
            When such a motor cannot move its load.
        """
        rows = {_key(row): _of_axis(a) for row, a in zip(np.eye(len(machine.axes)), machine.axes, strict=True)}
        for joint, row in zip(machine.joints, machine.kinematics.matrix, strict=True):
            given = _or_inf(joint.velocity), _or_inf(joint.acceleration), _or_inf(joint.jerk)
            own = _Row(f"joint {joint.name}", *given)
            if own[1:4] != (math.inf, math.inf, math.inf):
                rows[_key(row)] = own.tighten(rows.get(_key(row)))
        for index, row in enumerate(machine.kinematics.matrix if motors else ()):
            own = _of_motor(machine, index)
            if own is not None:
                rows[_key(row)] = own.tighten(rows.get(_key(row)))
        rows = _reserved(rows, machine)
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
            curves={i: row.curve for i, row in enumerate(rows.values()) if row.curve is not None},
            segment_time=machine.segment_time,
        )


class _Row(NamedTuple):
    """One limited quantity before it is a row of arrays."""

    name: str
    velocity: float
    acceleration: float
    jerk: float
    curve: AccelerationCurve | None = None

    def tighten(self, other: _Row | None) -> _Row:
        """Return the least of both under the name of the first that is below the other."""
        if other is None:
            return self
        binds = any(mine < theirs for mine, theirs in zip(self[1:4], other[1:4], strict=True))
        least = (min(self.velocity, other.velocity), min(self.acceleration, other.acceleration),
                 min(self.jerk, other.jerk))  # fmt: skip
        return _Row(self.name if binds else other.name, *least, _lesser(self, other))

    def scaled(self, velocity: float, acceleration: float, jerk: float) -> _Row:
        """Return the same with factors on its limits."""
        return _Row(self.name, velocity * self.velocity, acceleration * self.acceleration, jerk * self.jerk,
                    _scaled(self.curve, velocity, acceleration))  # fmt: skip


def _scaled(curve: AccelerationCurve | None, velocity: float, acceleration: float) -> AccelerationCurve | None:
    """Return a curve of lower speeds and accelerations; None stays None."""
    if curve is None:
        return None
    return AccelerationCurve(knots=tuple((velocity * v, acceleration * a) for v, a in curve.knots))


def _lesser(one: _Row, other: _Row) -> AccelerationCurve | None:
    """Return the curve that keeps both rows' accelerations, or None where neither has one."""
    if one.curve is not None and other.curve is not None:
        return one.curve.least(other.curve)
    if one.curve is not None:
        return one.curve.capped(other.acceleration)
    return None if other.curve is None else other.curve.capped(one.acceleration)


def _reserved(rows: dict[tuple[float, ...], _Row], machine: Machine) -> dict[tuple[float, ...], _Row]:
    """Return rows with what correcting a machine's errors takes kept free: of all joints that move with a row."""
    crossing = crossing_of(machine)
    if crossing is None:
        return rows
    moved = machine.kinematics.matrix != 0.0
    left = np.array(shares(machine, crossing.mix))
    return {key: row.scaled(*left[(moved & (np.array(key) != 0.0)).any(axis=1)].min(axis=0).tolist())
            for key, row in rows.items()}  # fmt: skip


def _of_motor(machine: Machine, index: int) -> _Row | None:
    """Return what a joint's motor can give, or None where the file does not name motor and driver."""
    motor = drive(machine, index)
    if motor is None:
        return None
    top = min(joint_velocity(machine, index), _REACHED * motor.greatest_velocity)
    name = f"motor {machine.joints[index].name}"
    if not top > 0.0:
        raise ConfigError("the motor cannot move its load", key=f"joints.{machine.joints[index].name}.load")
    curve = AccelerationCurve.below(motor.acceleration, top)
    return _Row(name, top, curve.knots[-1][1], math.inf, curve)


def _of_axis(axis: Axis) -> _Row:
    """Return an axis' limits; under a curve its speed ends with the curve, and a constant acceleration is its least."""
    name, curve = f"axis {axis.name}", axis.acceleration_curve
    if curve is None:
        return _Row(name, axis.velocity, axis.acceleration, _or_inf(axis.jerk))
    curve = curve.capped(axis.acceleration)
    velocity = min(axis.velocity, curve.top)
    return _Row(name, velocity, float(curve.at(velocity)), _or_inf(axis.jerk), curve)


def _key(row: NDArray[np.float64]) -> tuple[float, ...]:
    """Return a row of C as a key: the same quantity whichever way the joint counts."""
    leading = next((c for c in row if c != 0.0), 1.0)
    return tuple(float(c) + 0.0 for c in (row if leading > 0 else -row))


def _or_inf(value: float | None) -> float:
    return math.inf if value is None else value
