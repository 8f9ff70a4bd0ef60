"""One window of a road planned from rest to rest.  In: a road, where to begin and end, overrides.  Out: its phases.

The profile's own planner does the work: a window is a path like any other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.layout import PHASE
from trochia.planner.limits import Limits
from trochia.planner.live.pieces import cut_head
from trochia.planner.live.rows import copied, joined
from trochia.planner.plan import PROFILES, profile_of
from trochia.planner.rests import Rests
from trochia.toolpath import Toolpath

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.live.road import Place, Road
    from trochia.planner.live.rows import Reused
    from trochia.planner.schedule import Profile, Schedule

_FEW = 256  #: phases there is room for at least; most segments have one or two


@dataclass(frozen=True, slots=True, kw_only=True)
class Speeds:
    """Operator's overrides: ``feed`` scales programmed feeds, ``rapid`` (up to 1) the greatest speed of rapids."""

    feed: float = 1.0
    rapid: float = 1.0

    def __post_init__(self) -> None:
        if not 0.01 <= self.feed <= 2.0:
            raise ValueError(f"a feed override lies within 0.01 to 2, not {self.feed!r}; hold stops the motion")
        if not 0.01 <= self.rapid <= 1.0:
            raise ValueError(f"a rapid override lies within 0.01 to 1, not {self.rapid!r}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """What windows are planned by: the machine's limits, and the profile that keeps them."""

    limits: Limits
    profile: Profile
    name: str

    @classmethod
    def of(cls, machine: Machine, profile: str | None = None) -> Rules:
        """Return the rules of a machine; errors are those of :func:`trochia.planner.profile_of`."""
        name = profile_of(machine, profile)
        return cls(limits=Limits.of(machine, motors=PROFILES[name].by_curves), profile=PROFILES[name], name=name)

    @property
    def jerk_limited(self) -> bool:
        """Whether acceleration may not jump."""
        return self.profile.continuity > 1

    @property
    def stopping_time(self) -> float:
        """Return the worst stopping time from full speed on a straight line [s]: max over all limits of V/A + A/J."""
        limits, jerky = self.limits, self.jerk_limited
        rows = list(zip(limits.velocity, limits.acceleration, limits.jerk, strict=True))
        rows.append((limits.path_velocity, limits.path_acceleration, limits.path_jerk))
        return max(v / a + (a / j if jerky else 0.0) for v, a, j in rows if math.isfinite(v) and math.isfinite(a))


def plan_window(road: Road, rules: Rules, start: Place, end: int, speeds: Speeds) -> NDArray[Any]:
    """Return the phases (k,) from rest at ``start`` to rest before row ``end``: t from 0, segments by its rows."""
    phases = plan_rows(road, rules, start, end, speeds)
    kernel.move_phases(phases, phases, rows=start.row)
    return phases


def plan_rows(
    road: Road, rules: Rules, start: Place, end: int, speeds: Speeds, *, memory: Reused | None = None, room: int = 0
) -> NDArray[Any]:
    """Return the phases (k,) from rest at ``start`` to rest before row ``end``: t from 0, segments by rows from there.

    They lie in ``memory``, if there is any; ``room`` is how many there may well be.
    """
    axes = len(road.axes)
    rows, pool = road.rows(start.row, end), road.pool[:]
    if speeds != Speeds() or rules.limits.segment_time > 0.0 or start.s > 0.0:
        rows = copied(rows)
        scale_feeds(rows, pool, rules.limits, speeds)
        if rules.limits.segment_time > 0.0:
            np.minimum(rows["speed_limit"], rows["length"] / rules.limits.segment_time, out=rows["speed_limit"])
        rows, pool = cut_head(rows, pool, axes, start.s)
    where, seconds = road.rests_between(start.row, end)
    if start.s > 0.0:
        ahead = where > 0
        where, seconds = where[ahead], seconds[ahead]
    path = Toolpath(axes=road.axes, start=np.zeros(axes), segments=rows, pool=pool)
    schedule: Schedule = rules.profile(path, rules.limits, Rests(segments=where, seconds=seconds, times={}))
    size = max(2 * len(rows), room) + _FEW
    blocks = list(schedule.phases(size, None if memory is None else memory.take))
    phases = blocks[0] if len(blocks) == 1 else joined(blocks)
    if start.s > 0.0:
        phases["s"][phases["segment"] == 0] += start.s
    return phases


def scale_feeds(rows: NDArray[Any], pool: NDArray[np.float64], limits: Limits, speeds: Speeds) -> None:
    """Scale the programmed speeds of rows in place; a rapid gets one only when it is to be slower than it could."""
    rapid = ~np.isfinite(rows["speed_limit"])
    rows["speed_limit"] *= speeds.feed
    if speeds.rapid < 1.0 and rapid.any():
        states = np.zeros(int(rapid.sum()), dtype=PHASE)
        states["segment"], states["v"] = np.flatnonzero(rapid), 1.0
        along = np.abs(kernel.sample(rows, pool, limits.matrix.shape[1], states, 1) @ limits.matrix.T)
        most = 1.0 / (along / limits.velocity).max(axis=1)
        rows["speed_limit"][rapid] = speeds.rapid * np.minimum(most, limits.path_velocity)
