"""How much of each joint's limits a plan leaves unused.

In: a plan.  Out: for each joint the unused part of its speed and step rate, as fractions (0.25: a quarter is left;
below zero: over the limit).  Torque is None where the machine's file does not name motor and driver.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.machine.servos.drive import servo_drive

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.analysis.following import ServoUse
    from trochia.analysis.plan import Plan
    from trochia.analysis.torque import TorqueUse

Margins = dict[str, float | None]
LEAST = -99.0  #: margin where there is no torque at all: no finite number would be true


def margins(plan: Plan, torque: Mapping[str, TorqueUse], servos: Mapping[str, ServoUse]) -> dict[str, Margins]:
    """Return {joint: {"torque", "speed", "step_rate"}}; None where the machine gives no limit.

    ``torque`` is what :func:`trochia.analysis.torque.torque_use` found, ``servos`` what
    :func:`trochia.analysis.following.servo_use` did; the speed of a servo is also that of which its motor is capable.
    """
    machine, peaks = plan.machine, plan.trajectory.peaks
    axis_peaks = np.array([peaks[axis.name]["velocity"] or 0.0 for axis in machine.axes])
    axis_limits = np.array([axis.velocity for axis in machine.axes])
    result: dict[str, Margins] = {}
    used = {name: use.used for name, use in torque.items()} | {name: use.used for name, use in servos.items()}
    for i, (joint, row) in enumerate(zip(machine.joints, np.abs(machine.kinematics.matrix), strict=True)):
        # a joint of several axes is at most as fast as all of them together
        speed = float(row @ axis_peaks)
        limit = min(joint.velocity or np.inf, float(row @ axis_limits))
        drive = servo_drive(machine, i) if joint.name in servos else None
        limit = min(limit, drive.greatest_velocity) if drive is not None else limit
        rate = None if joint.steps_per_unit is None else speed * abs(float(joint.steps_per_unit))
        result[joint.name] = {
            "torque": max(1.0 - used[joint.name], LEAST) if joint.name in used else None,
            "speed": 1.0 - speed / limit,
            "step_rate": None if rate is None or joint.pulse_rate is None else 1.0 - rate / joint.pulse_rate,
        }
    return result
