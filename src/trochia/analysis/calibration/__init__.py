"""From measured points to what a machine file corrects: scale, screw table, backlash, squareness."""

from trochia.analysis.calibration.apply import AxisCalibration, calibrated, square
from trochia.analysis.calibration.fit import Found, Spot, fit
from trochia.analysis.calibration.points import Points, read_points
from trochia.analysis.calibration.squareness import by_deviation, by_diagonals

__all__ = [
    "AxisCalibration",
    "Found",
    "Points",
    "Spot",
    "by_deviation",
    "by_diagonals",
    "calibrated",
    "fit",
    "read_points",
    "square",
]
