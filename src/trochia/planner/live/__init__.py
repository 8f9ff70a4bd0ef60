"""Live planning: a program planned as it comes, held, resumed and overridden while it runs.

Values in, values out: nothing here knows a clock or a thread.
"""

from trochia.planner.live.liveplan import LivePlan, LiveState
from trochia.planner.live.portion import Portion
from trochia.planner.live.stream import StreamPlanner
from trochia.planner.live.window import Rules, Speeds

__all__ = ["LivePlan", "LiveState", "Portion", "Rules", "Speeds", "StreamPlanner"]
