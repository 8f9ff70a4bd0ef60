"""How speed is decided: geometry and limits in, motion over time out.

A velocity profile is one file and one row of :data:`PROFILES`.
"""

from trochia.kernels.layout import PHASE
from trochia.planner.binding import Binding
from trochia.planner.corners import path_of
from trochia.planner.limits import Limits
from trochia.planner.plan import PROFILES, plan, profile_of
from trochia.planner.rests import Rests, rests_of
from trochia.planner.schedule import Profile, Schedule
from trochia.planner.shaping import SHAPERS, Shaping
from trochia.planner.trajectory import Trajectory

__all__ = [
    "PHASE",
    "PROFILES",
    "SHAPERS",
    "Binding",
    "Limits",
    "Profile",
    "Rests",
    "Schedule",
    "Shaping",
    "Trajectory",
    "path_of",
    "plan",
    "profile_of",
    "rests_of",
]
