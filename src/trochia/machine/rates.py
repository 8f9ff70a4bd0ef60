"""What a machine can do, in closed form: joint speeds, step rates, braking distances.

Symbols: v velocity, a acceleration, j jerk, V path velocity, r one row of the kinematic matrix.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine


def joint_velocity(machine: Machine, joint: int) -> float:
    """Return the greatest speed a program can ask of a joint [mm/s or degree/s].

    The axes' limits give sum |r_i| v_i; the path's cap gives |r| V over the linear axes; the joint's own limit binds
    last.
    """
    row = machine.kinematics.matrix[joint]
    parts = [(abs(float(c)), axis) for c, axis in zip(row, machine.axes, strict=True)]
    linear = sum(c * axis.velocity for c, axis in parts if not axis.rotary)
    rotary = sum(c * axis.velocity for c, axis in parts if axis.rotary)
    if machine.path.velocity is not None:
        linear = min(linear, math.hypot(*(c for c, axis in parts if not axis.rotary)) * machine.path.velocity)
    own = machine.joints[joint].velocity
    return linear + rotary if own is None else min(linear + rotary, own)


def step_rate(machine: Machine, joint: int) -> float | None:
    """Return the greatest step rate a program can ask of a joint [1/s]; None for a servo."""
    steps = machine.joints[joint].steps_per_unit
    return None if steps is None else joint_velocity(machine, joint) * abs(float(steps))


def resolution(machine: Machine, joint: int) -> float | None:
    """Return the travel of one step, or of one encoder count without steps [mm or degree]; None when neither."""
    per_unit = machine.joints[joint].steps_per_unit or machine.joints[joint].counts_per_unit
    return None if per_unit is None else abs(float(1 / per_unit))


def braking_distance(axis: Axis) -> float:
    """Return the way from greatest velocity to rest [mm or degree].

    v²/2a; with a jerk limit v/2 (v/a + a/j), or v sqrt(v/j) where a is not reached.
    """
    v, a, j = axis.velocity, axis.acceleration, axis.jerk
    if j is None:
        return v * v / (2 * a)
    return v / 2 * (v / a + a / j) if v * j >= a * a else v * math.sqrt(v / j)
