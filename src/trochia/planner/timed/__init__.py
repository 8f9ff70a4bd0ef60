"""Moves given by time, not by speed: what a PMAC's PVT, LINEAR with TA and TS, SPLINE1 and SPLINE2 ask for.

Each law makes :class:`Pieces`, cubics in time; :func:`excesses` says which limits they exceed, for a time that is asked
for is kept; :func:`plan_timed` makes a trajectory of them.
"""

from trochia.planner.timed.excess import Excess, excesses
from trochia.planner.timed.fitted import fitted
from trochia.planner.timed.motion import plan_timed
from trochia.planner.timed.pieces import Pieces, joined, rest
from trochia.planner.timed.pvt import pvt
from trochia.planner.timed.ramps import Ramps, blended, ramps
from trochia.planner.timed.spline import spline1, spline2

__all__ = [
    "Excess",
    "Pieces",
    "Ramps",
    "blended",
    "excesses",
    "fitted",
    "joined",
    "plan_timed",
    "pvt",
    "ramps",
    "rest",
    "spline1",
    "spline2",
]
