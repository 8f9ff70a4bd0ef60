"""How far through its time a program is, also where it is gone back along.

In: its plan, plan times executed, when it is reversed and when resumed.  Out: time [s].  Forwards that is the time its
motion has taken; on a way back it falls in proportion to the time at which the plan reaches the place, and from there
it counts on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from trochia.analysis.plan import Plan
    from trochia.planner.live import LivePlan

_LOOK = 4096  #: segments behind that are looked through for the beginning of a source line
_PARTS = 256  #: that a time is sought in, each
_ROUNDS = 4
_SAME = 1e-9  #: places that near are the same [mm]


class Progress:
    """The progress of one job."""

    def __init__(self, plan: Plan, live: LivePlan) -> None:
        self._plan, self._live = plan, live
        self._lost = 0.0  # plan time that does not count: ways back, and what was gone back over
        self._back: tuple[float, float, float] | None = None  # where it was reversed: plan time, progress, own time

    def at(self, t: float) -> float:
        """Return the progress at a plan time executed [s]."""
        if self._back is None:
            return t - self._lost
        began, done, whole = self._back
        return done * self._own_time(max(t, began)) / whole if whole > 0.0 else 0.0

    def reverse(self, t: float) -> None:
        """Note that motion goes back from plan time ``t`` [s] on."""
        self._back = t, self.at(t), self._own_time(t)

    def resume(self, t: float) -> None:
        """Note that motion goes forwards from plan time ``t`` [s] on."""
        self._lost, self._back = t - self.at(t), None

    def _own_time(self, t: float) -> float:
        """Return when the plan, run without a stop, first reaches the place of a plan time executed [s]."""
        schedule = self._plan.trajectory.schedule
        if schedule is None:
            return 0.0
        row, s = self._place(t)
        low, high = 0.0, schedule.duration
        for _ in range(_ROUNDS):
            times = np.linspace(low, high, _PARTS + 1)
            states = schedule.states(times)
            reached = (states["segment"] > row) | ((states["segment"] == row) & (states["s"] >= s - _SAME))
            first = int(np.argmax(reached)) if reached.any() else _PARTS
            low, high = float(times[max(first - 1, 0)]), float(times[first])
        return high

    def _place(self, t: float) -> tuple[int, float]:
        """Return the row of the path under way, and how far along that row [mm]."""
        row, distance = self._live.along(max(t, 0.0))
        segments = self._plan.path.segments
        row = min(row, len(segments) - 1)
        first = max(row - _LOOK, 0)
        lines = self._plan.program.moves["line"][segments["move"][first : row + 1]]
        other = np.flatnonzero(lines[:-1] != lines[-1])
        begin = first + (int(other[-1]) + 1 if len(other) else 0)
        return row, distance - float(segments["length"][begin:row].sum())
