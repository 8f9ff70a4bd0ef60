"""Path geometry as the planner sees it: lines, arcs and blends, joined so that only their stops have corners.

In: a :class:`~trochia.program.Program` and the machine's axes.  Out: a :class:`Toolpath`, what it measures, and whether
it stays inside the travel.  No time, no limits.
"""

from trochia.kernels.layout import SEGMENT
from trochia.toolpath.build import SPLINE_ERROR, build, rests_before
from trochia.toolpath.measure import Measure, measure, measure_program
from trochia.toolpath.toolpath import SegmentKind, Toolpath
from trochia.toolpath.travel import Outside, first_outside, fitting_shift

__all__ = [
    "SEGMENT",
    "SPLINE_ERROR",
    "Measure",
    "Outside",
    "SegmentKind",
    "Toolpath",
    "build",
    "first_outside",
    "fitting_shift",
    "measure",
    "measure_program",
    "rests_before",
]
