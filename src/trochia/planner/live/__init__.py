"""Live planning: a program planned as it comes, held, resumed and overridden while it runs.

Values in, values out: nothing here knows a clock or a thread.
"""

from trochia.planner.live.portion import Portion
from trochia.planner.live.stream import StreamPlanner

__all__ = ["Portion", "StreamPlanner"]
