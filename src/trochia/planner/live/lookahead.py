"""Look-ahead in bounded windows.  In: a road, rules, where motion begins at rest.  Out: phases, and which are final.

Each window ends at rest: there is always a stop in hand.  Its end is not final, as the whole program would pass there
at speed; all but the last *settling time* of it is.  The next window begins, at rest too, so far behind what is final
that both have come to the same speed there; at that joint the one goes on as the other.  That they agree is checked,
so nothing is assumed of the profile; where they do not, the window begins earlier, at last where motion was at rest
indeed.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.layout import PHASE
from trochia.planner.live.change import Ahead, change
from trochia.planner.live.hold import hold
from trochia.planner.live.portion import moved_on, states_at
from trochia.planner.live.road import Place
from trochia.planner.live.rows import Reused, copied, joined, put
from trochia.planner.live.window import plan_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.planner.live.road import Road
    from trochia.planner.live.window import Rules, Speeds

SETTLE = 2.0  #: settling time, in worst stopping times: on bends less than the whole limit is left for braking
WARM = 3.0  #: how far behind a window begins, in the same
WINDOW = 40.0  #: how much a window adds, in the same, where motion may yet be told to change
FIRST = 5.0  #: and the first, so that motion begins soon
GROWTH = 4.0  #: times the window before
_SAME_PLACE = 1e-9  #: mm or degree
_SAME_SPEED = 1e-9  #: of each other
_SAME_ACCELERATION = 1e-7  #: of the limit


class Lookahead:
    """Motion along a road from rest at ``start``, planned as it is asked for.

    Attributes
    ----------
    phases
        Those in hand (k,) of PHASE: t from the start of all motion, segments by the road's rows; they end at rest.
    safe
        How many of them are final.
    stopped
        Whether they end at rest because they were told to.

    Parameters
    ----------
    start, t
        Where and when motion begins.
    rested
        Whether the rest that stands before that place is over.
    window
        How much a window adds, in worst stopping times; None: :data:`WINDOW`.
    whole
        Whether it goes on to the end of what the road has in hand by then: few long segments are not worth a window.
    """

    def __init__(
        self,
        road: Road,
        rules: Rules,
        start: Place,
        t: float,
        speeds: Speeds,
        *,
        rested: bool = False,
        window: float | None = None,
        whole: bool = False,
    ) -> None:
        self.road, self.rules, self.speeds = road, rules, speeds
        self.stopped = False
        self._start, self._begin, self._rested = start, t, rested
        self._feed = speeds.feed  # greatest that the phases in hand are planned for
        self._stop = rules.stopping_time
        axes, caps = rules.limits.matrix.shape[1], rules.limits
        self._most = min(float(np.linalg.norm(caps.velocity[:axes])), caps.path_velocity)  # speed there ever is
        self._span, self._window, self._whole = FIRST, WINDOW if window is None else window, whole
        self._end = self._reach(start.row, FIRST + SETTLE)
        self._windows, self._most_phases = Reused(PHASE), 0  # where windows are planned; phases of one so far
        self._memory, self._at = np.empty(0, dtype=PHASE), 0  # what phases that are gone on with lie in, and where
        self.phases = self._from(start, t)
        self.safe = 0
        self._settle()

    @property
    def finished(self) -> bool:
        """Whether all of the program is planned, and final."""
        return self.road.ended and self._end >= self.road.end

    @property
    def safe_time(self) -> float:
        """Until when the phases are final [s]."""
        return self._end_of(self.safe)

    @property
    def end_time(self) -> float:
        """When the phases in hand come to rest [s]."""
        return self._end_of(len(self.phases))

    def extend(self) -> bool:
        """Plan further until more is final; False when all is final already."""
        if self.finished or self.stopped:
            return False
        before = self.safe
        while self.safe == before and not self.finished:
            self._end = self._reach(self._end, self._span)
            self._join()
            self._settle()
            self._span = min(GROWTH * self._span, self._window)
        return True

    def state(self, t: float) -> NDArray[Any]:
        """Return the state of motion at an instant in hand (a row of PHASE)."""
        self.reach(t)
        return states_at(self.phases, np.array([t]))[0]

    def rested_before(self, t: float) -> Place:
        """Return where motion last began at rest before ``t``, or else where the motion in hand begins."""
        standing = np.flatnonzero((self.phases["v"] == 0.0) & (self.phases["flags"] == 0) & (self.phases["t"] <= t))
        first = self.phases[standing[-1] if len(standing) else 0]
        return Place(int(first["segment"]), float(first["s"]))

    def window_from(self, row: int) -> int:
        """Return where a window that begins at a row ends."""
        return self._reach(row, FIRST + SETTLE)

    def passes(self, place: Place) -> float:
        """Return when motion passes a place [s], planning as far as that."""
        while int(self.phases["segment"][self.safe - 1 if self.safe else 0]) <= place.row and self.extend():
            pass
        return Ahead(self.road, self.phases, place).begin

    def place_of_end(self) -> Place:
        """Return where the motion in hand ends."""
        last = self.phases[-1:]
        end = moved_on(last, last["duration"], last["t"])[0]
        length = float(self.road.segments["length"][int(end["segment"]) - self.road.base])
        if float(end["s"]) >= length - 1e-9:
            return Place(int(end["segment"]) + 1, 0.0)
        return Place(int(end["segment"]), float(end["s"]))

    def reach(self, t: float) -> None:
        """Plan until the motion is final to ``t`` at least, or to its end."""
        while self.safe_time < t and self.extend():
            pass

    def stop(self, t: float) -> None:
        """Come to rest as soon as can be from ``t`` on; nothing is planned beyond."""
        self.reach(t)
        self.phases = hold(self.road, self.rules, self.phases, t, self._feed)
        self.safe, self.stopped = len(self.phases), True

    def change(self, t: float, speeds: Speeds) -> None:
        """Go over to other speeds as soon as can be from ``t`` on."""
        self.reach(t + FIRST * self._stop)
        self._feed, self.speeds = max(self.speeds.feed, speeds.feed), speeds
        self._span, old = FIRST, self.phases
        row = int(states_at(old, np.array([t]))["segment"][0])
        self._end = max(self._reach(row, 2.0 * FIRST + SETTLE), int(old["segment"][-1]) + 1)
        if self.road.ended:
            self._end = min(self._end, self.road.end)
        while True:
            led, rest = self._way_over(old, t)
            self.phases, self.safe = joined([led, rest]), 0
            self._settle(len(led))
            if self.safe or self.finished:
                return
            self._end = self._reach(self._end, self._span)
            self._span = min(GROWTH * self._span, self._window)

    def _way_over(self, old: NDArray[Any], t: float) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the phases in hand up to where the plan for other speeds goes on, and what goes on."""
        standing = np.flatnonzero((old["v"] == 0.0) & (old["flags"] == 0) & (old["t"] >= t))
        until = float(old["t"][standing[0]]) if len(standing) else float(old["t"][-1] + old["duration"][-1])
        joints = _joints(old)
        behind = joints[old["t"][joints] <= t - WARM * self._stop]
        start = Place(int(old["segment"][behind[-1]]), 0.0) if len(behind) else self._first()
        found = change(self.road, self.rules, old, self._from(start, 0.0), t, feed=self._feed, until=until)
        if found is not None:
            return found
        if not len(standing):
            return old, self._from(Place(int(old["segment"][-1]) + 1, 0.0), until)
        here = old[standing[0]]
        fresh = self._from(Place(int(here["segment"]), float(here["s"])), 0.0)
        return old[: standing[0]], _dated(fresh[fresh["flags"].argmin() :], until)

    def forget(self, t: float) -> int:
        """Drop phases that end before ``t`` and that no further window needs; return how many."""
        most = self.safe_time - 4.0 * WARM * self._stop
        drop = _joint_before(self.phases, min(t, most), 0)
        if drop:
            self.phases, self._at = self.phases[drop:], self._at + drop
            self.safe -= drop
            self.road.trim(int(self.phases["segment"][0]))
        return drop or 0

    def _end_of(self, count: int) -> float:
        if not count:
            return self._begin if not len(self.phases) else float(self.phases["t"][0])
        last = self.phases[count - 1]
        return float(last["t"] + last["duration"])

    def _from(self, start: Place, t: float) -> NDArray[Any]:
        """Return the motion from rest at a place to the end of the window, begun at ``t``."""
        phases = self._raw(start)
        kernel.move_phases(phases, phases, later=t - float(phases["t"][0]), rows=start.row)
        return phases

    def _raw(self, start: Place) -> NDArray[Any]:
        """Return the same, but its segments count from that place."""
        if self._end > start.row:
            phases = plan_rows(self.road, self.rules, start, self._end, self.speeds,
                               memory=self._windows, room=self._most_phases)  # fmt: skip
            self._most_phases = max(self._most_phases, len(phases))
        else:
            phases = _still(self.road, start)
        return phases[phases["flags"].argmin() :] if self._rested and start == self._start else phases

    def _reach(self, row: int, times: float) -> int:
        """Return the row some (worst stopping) times after ``row``, if all went at full speed, or one farther on."""
        road, wanted, end = self.road, times * self._stop, row
        while wanted > 0.0:
            if end >= road.end and not road.more():
                return road.end
            count, wanted = kernel.reach(road.rows(end, road.end), wanted, feed=self.speeds.feed, most=self._most)
            end += count
        end = road.end if self._whole else end
        if end >= road.end:
            road.more()  # whether the program ends here
        return end

    def _settle(self, least: int = 0) -> None:
        """Find how many phases, ``least`` or none, are final: to the last joint a settling time before the end."""
        if self.finished:
            self.safe = len(self.phases)
            return
        joint = _joint_before(self.phases, self.end_time - SETTLE * self._stop, max(self.safe, least))
        if joint is not None:
            self.safe = joint

    def _join(self) -> None:
        """Plan to the new end, and go on so where both plans agree."""
        old, joint = self.phases, self.safe
        if joint == 0:
            self.phases = self._from(self._start, self._begin)
            return
        t = float(old["t"][joint])
        warm = WARM * self._stop
        while True:
            behind = _joint_before(old, t - warm, 0)
            start = self._first() if behind is None else Place(int(old["segment"][behind]), 0.0)
            new = self._raw(start)
            if self._splice(new, start.row, [joint]):
                return
            if behind is None:
                break
            warm *= 2.0
        joints = _joints(old)
        if not self._splice(new, start.row, [int(k) for k in joints[joints > joint]]):
            rest = self.end_time
            self.phases = joined([old, self._from(Place(int(old["segment"][-1]) + 1, 0.0), rest)])

    def _first(self) -> Place:
        """Return where the phases in hand begin: at rest where motion does, else at a joint."""
        first = self.phases[0]
        if first["t"] <= self._begin:
            return self._start
        joint = int(_joints(self.phases)[0])
        return Place(int(self.phases["segment"][joint]), 0.0)

    def _splice(self, new: NDArray[Any], row: int, joints: list[int]) -> bool:
        """Go on as ``new`` from the first of some joints where it agrees with the phases in hand; False: nowhere.

        The segments of ``new`` count from ``row``.
        """
        segments = new["segment"]
        for joint in joints:
            here = self.phases[joint]
            segment = int(here["segment"]) - row
            k = bisect_left(segments, segment)
            while k < len(new) and new["flags"][k] & 1:
                k += 1
            if k < len(new) and segments[k] == segment and self._agree(here, new[k]):
                self._go_on(joint, new[k:], row)
                return True
        return False

    def _go_on(self, count: int, rest: NDArray[Any], row: int) -> None:
        """Go on as ``rest`` behind the first ``count`` phases in hand, which are copied only now and then."""
        later = float(self.phases["t"][count] - rest["t"][0])
        if self.phases.base is not self._memory or self._at + count + len(rest) > len(self._memory):
            kept = copied(self.phases[:count])
            if self.phases.base is not self._memory or count + len(rest) > len(self._memory):
                self._memory = np.empty((count + len(rest)) * 5 // 4, dtype=PHASE)
            self._at = 0
            put(kept, self._memory[:count])
        end = self._at + count + len(rest)
        kernel.move_phases(rest, self._memory[end - len(rest) : end], later=later, rows=row)
        self.phases = self._memory[self._at : end]

    def _agree(self, here: NDArray[Any], there: NDArray[Any]) -> bool:
        if there["s"] > _SAME_PLACE or abs(here["v"] - there["v"]) > _SAME_SPEED * (here["v"] + there["v"]):
            return False
        small = _SAME_ACCELERATION * float(self.rules.limits.acceleration.min())
        return not self.rules.jerk_limited or bool(abs(here["a"] - there["a"]) <= small)


def _dated(phases: NDArray[Any], t: float) -> NDArray[Any]:
    """Return phases begun at ``t``."""
    phases = phases.copy()
    if len(phases):
        phases["t"] += t - phases["t"][0]
    return phases


def _joints(phases: NDArray[Any]) -> NDArray[np.intp]:
    """Return which phases begin where their segment begins, in motion (j,), rising."""
    moving = np.flatnonzero(phases["flags"] == 0)
    segments = phases["segment"][moving]
    fresh = np.ones(len(moving), dtype=np.bool_)
    fresh[1:] = segments[1:] != segments[:-1]
    fresh &= phases["s"][moving] <= _SAME_PLACE
    return moving[fresh]


def _joint_before(phases: NDArray[Any], t: float, least: int) -> int | None:
    """Return the last phase, ``least`` or later, that begins where its segment does, in motion and not after ``t``."""
    segments, places, flags = phases["segment"], phases["s"], phases["flags"]
    for k in range(bisect_right(phases["t"], t) - 1, least - 1, -1):
        if flags[k] or places[k] > _SAME_PLACE:
            continue
        before = k - 1
        while before >= 0 and flags[before]:
            before -= 1
        if before < 0 or segments[before] != segments[k]:
            return k
    return None


def _still(road: Road, start: Place) -> NDArray[Any]:
    """Return the phases where nothing moves any more: one rest, be it of no time; segments count from there."""
    _, seconds = road.rests_between(start.row, road.end)
    phases = np.zeros(1, dtype=PHASE)
    phases["duration"], phases["flags"] = seconds.sum(), 1
    phases["segment"] = max(start.row - 1, 0) - start.row & 0xFFFFFFFF  # the row before
    if start.row > road.base:
        phases["s"] = road.segments["length"][start.row - 1 - road.base]
    return phases
