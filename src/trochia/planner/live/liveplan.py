"""Motion that is told while it runs to stop, to go on, and how fast.  In: a program's motion, and what is told when.

Out: the state at any instant.  Instants are given, never read from a clock: the same calls give the same motion.  What
is told for an instant must not be told before it is the first that no backend holds yet.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import PlanningError
from trochia.planner.live.back import behind, forward_of, run_up, way_back
from trochia.planner.live.lookahead import Lookahead
from trochia.planner.live.paving import pave
from trochia.planner.live.portion import Portion, between
from trochia.planner.live.road import Place, Road, Stretch
from trochia.planner.live.window import Rules, Speeds
from trochia.planner.rests import rests_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.trajectory import Trajectory
    from trochia.program import Program


_LOOK = 4096  #: segments behind that are looked through for the beginning of a source line


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveState:
    """Motion at one instant.

    Attributes
    ----------
    t
        The instant [s].
    position
        Of the axes (n,) [mm, degree].
    speed, acceleration
        ds/dt, and its derivative; speed is below zero where motion backs up.
    line
        Source line of the move under way.
    power
        Of the beam, or S of the spindle; 0 in a rest, and from a hold until the place where it began is passed again.
    """

    t: float
    position: NDArray[np.float64]
    speed: float
    acceleration: float
    line: int
    power: float


@dataclass(slots=True)
class _Leg:
    """Part of the motion: along the program, or back to where it takes up speed again."""

    begin: float
    ahead: Lookahead
    start: Place  # where on the program's road it begins
    dark_to: Place | None = None  # the beam is lit from there on,
    dark_from: float = np.inf  # and until then
    back_to: Place | None = None  # of a leg back: where it leads
    stays: bool = False  # of a leg back: motion rests at its end

    def dark(self, state: NDArray[Any]) -> bool:
        """Whether the beam is off at a state on the leg's own road."""
        place = Place(int(state["segment"]), float(state["s"]))
        before = self.dark_to is not None and place < self.dark_to
        return self.back_to is not None or before or bool(state["t"] >= self.dark_from)


class LivePlan:
    """The motion of one program on one machine.

    Parameters
    ----------
    road
        The program's path, as it comes.
    rules
        What motion keeps to.
    speeds
        Overrides to begin with.
    """

    def __init__(self, road: Road, rules: Rules, speeds: Speeds | None = None) -> None:
        self.speeds = speeds or Speeds()
        self._road, self._rules = road, rules
        self._legs = [_Leg(0.0, Lookahead(road, rules, Place(0, 0.0), 0.0, self.speeds), Place(0, 0.0))]

    @classmethod
    def of(cls, trajectory: Trajectory, machine: Machine) -> LivePlan:
        """Return the live motion of a program that is planned; until told otherwise it is that trajectory.

        Its ``shaping`` acts on what comes out, and is not part of it.
        """
        rests = rests_of(trajectory.program, machine, trajectory.path)
        stretch = Stretch.of(trajectory.path, trajectory.program, rests)
        return cls(Road.whole(trajectory.path.axes, stretch), Rules.of(machine, trajectory.profile))

    @classmethod
    def streaming(cls, blocks: Iterable[Program], machine: Machine, *, profile: str | None = None) -> LivePlan:
        """Return the live motion of a program that is planned as its blocks come (see ``StreamPlanner``)."""
        rules = Rules.of(machine, profile)
        axes = "".join(axis.name for axis in machine.axes)
        return cls(Road(axes, pave(blocks, machine, rules.profile)), rules)

    @property
    def rules(self) -> Rules:
        """What the motion keeps to."""
        return self._rules

    @property
    def end(self) -> float | None:
        """When the motion ends, or comes to rest in a hold [s]; None while that is not planned yet."""
        ahead = self._legs[-1].ahead
        return ahead.end_time if ahead.finished or ahead.stopped else None

    @property
    def held(self) -> bool:
        """Whether what was told last ends at rest on the way: a hold, or going back."""
        return self._legs[-1].ahead.stopped or self._legs[-1].stays

    def hold(self, t: float) -> float:
        """Brake along the path from ``t`` on, as soon as can be; return when motion rests [s].

        The beam is dark from ``t`` on.
        """
        leg = self._leg(t)
        if not leg.ahead.stopped:
            self._legs = self._legs[: self._legs.index(leg) + 1]
            leg.dark_from = t
            leg.ahead.stop(t)
        return leg.ahead.end_time

    def resume(self, t: float, *, relight: bool = False) -> float:
        """Go on from ``t``, at which motion rests; return when the motion is again where it was held [s].

        Parameters
        ----------
        relight
            Whether to back up first, so that the beam relights at speed exactly where it went out.

        Raises
        ------
        PlanningError
            When motion is not held, or does not rest yet.
        """
        leg, place = self._legs[-1], self._resting(t)
        if leg.back_to is None and self._road.ended and place.row >= self._road.end:
            leg.ahead.stopped = False  # nothing is left to go on with
            return t
        if leg.stays:
            self._legs.append(_Leg(t, Lookahead(self._road, self._rules, place, t, self.speeds, rested=True), place))
            return t
        if leg.back_to is not None:
            return self._again(place, leg.back_to, leg.dark_to or place, t)
        out = leg.ahead.state(leg.dark_from)
        if not relight or not (out["v"] > 0.0 or leg.dark_to):
            self._legs.append(_Leg(t, Lookahead(self._road, self._rules, place, t, self.speeds), place))
            return t
        place_out = Place(int(out["segment"]), float(out["s"]))
        if leg.dark_to is not None and place_out < leg.dark_to:
            return self._again(place, leg.start, leg.dark_to, t)
        return self._again(place, run_up(leg.ahead, leg.dark_from, self.speeds), place_out, t)

    def back_up(self, t: float, way: float, *, earliest: int = 0) -> float:
        """Go back along the path from ``t``, at which motion rests, and stay there; return when it rests again [s].

        It goes back by ``way`` [mm], to the beginning of segment ``earliest`` at most, dark.  A resume goes on from
        there.

        Raises
        ------
        PlanningError
            When motion is not held, or does not rest yet.
        """
        place = self._resting(t)
        end = max(behind(self._road, place, way), Place(earliest, 0.0))
        back = way_back(self._road, place, end) if end < place else None
        if back is None:
            return t
        ahead = Lookahead(back, self._rules, Place(0, 0.0), t, Speeds())
        ahead.reach(np.inf)
        self._legs.append(_Leg(t, ahead, place, back_to=end, stays=True))
        return ahead.end_time

    def _resting(self, t: float) -> Place:
        """Return where on the program's road motion rests at ``t``, in a hold."""
        leg = self._legs[-1]
        if not self.held or t < leg.ahead.end_time:
            raise PlanningError(
                "only a motion that rests in a hold goes on, or back", hint="Hold it, and wait for its rest."
            )
        place = leg.ahead.place_of_end()
        return place if leg.back_to is None else forward_of(leg.start, leg.ahead.road, place, leg.back_to)

    def _again(self, place: Place, start: Place, dark_to: Place, t: float) -> float:
        """Back up from a place to ``start``, and go on from there, dark to ``dark_to``; return when that is passed."""
        back = way_back(self._road, place, start)
        if back is not None:
            ahead = Lookahead(back, self._rules, Place(0, 0.0), t, Speeds())
            ahead.reach(np.inf)
            self._legs.append(_Leg(t, ahead, place, dark_to=dark_to, back_to=start))
            t = ahead.end_time
        ahead = Lookahead(self._road, self._rules, start, t, self.speeds, rested=True)
        self._legs.append(_Leg(t, ahead, start, dark_to=dark_to))
        return ahead.passes(dark_to)

    def override(self, t: float, *, feed: float | None = None, rapid: float | None = None) -> None:
        """Scale programmed feeds (0.01 to 2), or slow rapids (0.01 to 1), from ``t`` on, as soon as can be.

        Raises
        ------
        ValueError
            For another part of the speed.
        """
        self.speeds = Speeds(
            feed=self.speeds.feed if feed is None else feed, rapid=self.speeds.rapid if rapid is None else rapid
        )
        leg, last = self._leg(t), self._legs[-1]
        if leg.back_to is not None and last is not leg:
            last.ahead = Lookahead(self._road, self._rules, last.start, last.begin, self.speeds, rested=True)
        elif leg.back_to is None and not leg.ahead.stopped:
            leg.ahead.change(t, self.speeds)

    def state(self, t: float) -> LiveState:
        """Return the motion at an instant that is not forgotten."""
        leg = self._leg(t)
        leg.ahead.reach(t)
        phases = leg.ahead.phases
        row = min(max(int(np.searchsorted(phases["t"], t, side="right")) - 1, 0), len(phases) - 1)
        part = Portion.of(leg.ahead.road, phases[row : row + 1])
        state, sign = part.states([t])[0], 1.0 if leg.back_to is None else -1.0
        dark = leg.dark(leg.ahead.state(t))
        return LiveState(t=t, position=part.position([t])[0], speed=sign * float(state["v"]),
                         acceleration=sign * float(state["a"]), line=int(part.line_at([t])[0]),
                         power=0.0 if dark else float(part.power_at([t])[0]))  # fmt: skip

    def along(self, t: float) -> tuple[int, float]:
        """Return at an instant the row of the program's path under way, and how far along its source line [mm]."""
        leg = self._leg(t)
        state = leg.ahead.state(t)
        place = Place(int(state["segment"]), float(state["s"]))
        if leg.back_to is not None:
            place = forward_of(leg.start, leg.ahead.road, place, leg.back_to)
        road = self._road
        row = min(place.row, road.end - 1)
        first = max(row - _LOOK, road.base)
        lines = road.lines(first, row + 1) if row >= first else np.zeros(1, np.uint32)
        other = np.flatnonzero(lines[:-1] != lines[-1])
        begin = first + (int(other[-1]) + 1 if len(other) else 0)
        way = road.segments["length"][begin - road.base : row - road.base]
        return place.row, float(way.sum()) + place.s

    def portions(self, begin: float, end: float) -> Iterator[Portion]:
        """Yield the motion from one instant to another as portions; at rest in a hold there is none."""
        for leg, until in zip(self._legs, [*(leg.begin for leg in self._legs[1:]), np.inf], strict=True):
            low, high = max(begin, leg.begin), min(end, until)
            if low >= high:
                continue
            leg.ahead.reach(high)
            phases = between(leg.ahead.phases, low, high)
            if len(phases):
                yield Portion.of(leg.ahead.road, phases, backwards=leg.back_to is not None)

    def forget(self, t: float) -> None:
        """Drop what lies before ``t``, but for what a run-up may need."""
        self._legs = self._legs[self._legs.index(self._leg(t)) :]
        leg = self._legs[0]
        if leg.back_to is None and not leg.ahead.stopped:
            leg.ahead.forget(t)

    def _leg(self, t: float) -> _Leg:
        return next((leg for leg in reversed(self._legs) if leg.begin <= t), self._legs[0])
