"""Sweeps of a stepper: its torque-speed curve by closed form and as measured on the twin, its limits, its size.

In: a motor behind its driver, a load.  Out: torques and speeds, a picture, a verdict.
"""

from trochia.analysis.sweep.curve import Curve, curve
from trochia.analysis.sweep.limits import Limits, compare, limits
from trochia.analysis.sweep.points import OperatingPoints, operating_points
from trochia.analysis.sweep.procedures import (
    TIMINGS,
    Timing,
    pull_in_torque,
    pull_out_speed,
    pull_out_torque_measured,
    start_stop_speed_measured,
    start_stop_speeds,
)

__all__ = [
    "TIMINGS",
    "Curve",
    "Limits",
    "OperatingPoints",
    "Timing",
    "compare",
    "curve",
    "limits",
    "operating_points",
    "pull_in_torque",
    "pull_out_speed",
    "pull_out_torque_measured",
    "start_stop_speed_measured",
    "start_stop_speeds",
]
