"""Where a program uses its motors: speed and torque of a joint, instant by instant.

In: a plan and a joint.  Out: operating points of its shaft, few enough to draw, none of the outermost left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.torque import samples_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.plan import Plan
    from trochia.machine.torque import Drive

    Floats = NDArray[np.float64]

CELLS = 120  #: of speed and of torque, in each of which one point is kept


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoints:
    """Points of a shaft: speed [rad/s], torque along the motion [N·m], source line, each (n,), and effective torque.

    Attributes
    ----------
    rms
        Effective torque over the whole program, rests included [N·m].
    duty
        Part of the time in which it turns.
    """

    speed: Floats
    torque: Floats
    line: NDArray[np.uint32]
    rms: float
    duty: float


def operating_points(plan: Plan, joint: int, motor: Drive) -> OperatingPoints:
    """Return the points of a joint by its number: in each cell of speed and torque the one furthest out."""
    row = plan.machine.kinematics.matrix[joint]
    kept: dict[tuple[int, int], tuple[float, float, int]] = {}
    top = max(1e-9, float(np.abs(row) @ [axis.velocity for axis in plan.machine.axes]) / abs(motor.per_radian))
    squares = turning = count = 0.0
    for block in samples_of(plan):
        speed = np.abs(block.velocity @ row / motor.per_radian)
        torque = motor.needed(block.velocity @ row, block.acceleration @ row) + _friction(motor, speed)
        squares += float(torque @ torque)
        turning += float((speed > 0).sum())
        count += len(speed)
        cells = np.column_stack([np.rint(CELLS * speed / top), np.rint(CELLS * torque / motor.made.holding)])
        _, first = np.unique(cells.astype(np.int64), axis=0, return_index=True)
        for i in first.tolist():
            place = (int(cells[i, 0]), int(cells[i, 1]))
            point = (float(speed[i]), float(torque[i]), int(block.line[i]))
            if place not in kept or abs(point[1]) > abs(kept[place][1]):
                kept[place] = point
    points = sorted(kept.values())
    return OperatingPoints(
        speed=np.array([p[0] for p in points]),
        torque=np.array([p[1] for p in points]),
        line=np.array([p[2] for p in points], np.uint32),
        rms=float(np.sqrt(squares / count)) if count else 0.0,
        duty=turning / count if count else 0.0,
    )


def _friction(motor: Drive, speed: Floats) -> Floats:
    """Return the frictions of the load at shaft speeds (n,) [N·m]; the motor's own are off its curve."""
    return np.where(speed > 0, motor.load.friction + motor.load.viscous * speed, 0.0)
