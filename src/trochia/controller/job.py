"""A program under way: its motion, and what happens along it.

In: a plan, what the backend has run through.  Out: orders, and events: paused, ended.  Actions of the program that set
something go with the motion, each at its stream time; those that wait for somebody end what is sent until they are
answered.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import Orders, Watch
from trochia.controller.awaited import Awaited
from trochia.controller.doings import Doings
from trochia.controller.feeder import ROW, Feeder
from trochia.controller.progress import Progress
from trochia.controller.states import Event
from trochia.errors import LocalProtocolError
from trochia.planner.live import LivePlan
from trochia.program import Action, Pause, Probe, ToolChange, UserCode, WaitInput

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.analysis.plan import Plan
    from trochia.backends.live import Report
    from trochia.controller.rerun import Entry
    from trochia.machine.machine import Machine
    from trochia.planner.live import Portion

REST = 1  #: flag of a phase at rest
BLOCK_END = Pause(at=-1, line=0, optional=False)  #: what a job run block by block waits at


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """How a job is run: the operator's switches and overrides as they stand at its start."""

    optional_stop: bool = False
    block_by_block: bool = False
    dark: bool = False  # beam and spindle stay off
    feed: float = 1.0
    rapid: float = 1.0
    spindle: float = 1.0


class Job:
    """One program under way.

    Parameters
    ----------
    origin
        Stream time at which it begins [s].
    ahead
        Motion the backend wants to hold [s].
    after
        The part of the program that was run before this.

    Attributes
    ----------
    waiting
        The action the program waits at, or None.
    by_block
        Whether it rests after each block.
    entry
        Where in the program it begins, if not at its start.
    asks
        What it asks at its end, and is to go on from with the answer.
    probing
        Whether it is on its probing move.
    """

    def __init__(
        self, plan: Plan, machine: Machine, options: Options, *, origin: float, ahead: float,
        asks: Action | None = None, after: Job | None = None,
    ) -> None:  # fmt: skip
        self.plan = plan
        self.options = options
        self.waiting: Action | None = None
        self.by_block = options.block_by_block if after is None else after.by_block
        self.entry: Entry | None = None
        self.asks, self.probing = asks, False
        self._waits_for = Awaited(asks, machine) if isinstance(asks, WaitInput) else None
        self.doings = Doings(plan.program, machine, dark=options.dark, spindle=options.spindle,
                             after=None if after is None else after.doings)  # fmt: skip
        self._machine = machine
        live = LivePlan.of(plan.trajectory, machine)
        if (options.feed, options.rapid) != (1.0, 1.0):
            live.override(0.0, feed=options.feed, rapid=options.rapid)
        self.feeder = Feeder(live, machine, origin=origin, ahead=ahead, power=self.doings.power)
        self._progress = Progress(plan, live)
        self._moves = plan.path.segments["move"]
        self._actions = plan.program.actions
        self._next = 0  # number of the first action that has not been sent
        self._sent: list[tuple[float, int]] = []  # (plan time, number) of actions that were
        self._paused_at: float | None = None
        self._block: int | None = None  # source line that may be run, block by block
        self._given_up = False  # the probing move

    # -- what the controller asks for

    def feed(self, report: Report) -> Iterator[Orders]:
        """Yield the next orders; none where enough is held."""
        if self.probing and report.caught is not None:
            return
        for segments, at, portions in self.feeder.more(report.executed, self._until):
            timed = self._timed(portions)
            yield Orders(segments=segments, at=at, timed=tuple(timed))

    def event(self, report: Report) -> Event | None:
        """Return what has come about: the program waits or asks, was answered, or is at its end."""
        if self.probing:
            return self._probed(report)
        if not self.feeder.done(report.executed):
            return None
        if self.waiting is None and not self.feeder.live.held:
            waits = (action for action in self._actions[self._next :] if self._waits(action))
            self.waiting = next(waits, None)  # one that stands behind the last move
        if isinstance(self.waiting, Probe):
            return Event.PROBE
        if self.waiting is None and self._waits_for is not None and not self.feeder.live.held:
            return Event.ANSWER if self._waits_for.look(report) is not None else None
        return Event.PAUSED if self.waiting is not None else Event.STILL

    def rest_first(self) -> None:
        """Wait before the first move, block by block: what came before it was a block."""
        if self.by_block and len(self.plan.program.moves):
            self._pause(0.0, BLOCK_END)

    def probe(self, name: str) -> Orders:
        """Go on with the probing move that it waits at; return the order to watch the probe."""
        assert isinstance(self.waiting, Probe), "it waits at a probing move"
        watch = Watch(name=name, level=self.waiting.toward)
        self.probing = True
        self._pass()
        return Orders(watch=(watch,))

    @property
    def read(self) -> float:
        """What M66 has read; -1: its time was over."""
        assert self._waits_for is not None, "it asks for an input"
        assert self._waits_for.value is not None, "it has answered"
        return self._waits_for.value

    def finish(self, *, whole: bool) -> Orders:
        """Return what the actions up to the next that waits, or the program's end, set at once; nothing if given up."""
        outputs: dict[str, float] = {}
        whole = whole and self.waiting is not BLOCK_END  # there what follows goes with the next block
        while whole and self._next < len(self._actions) and self._actions[self._next] is not self.waiting:
            outputs.update(self.doings.sets(self._actions[self._next]))
            self._next += 1
        return Orders(outputs=outputs)

    def hold(self, report: Report, latency: float) -> None:
        """Brake along the path as soon as an order can act; a probing move is given up."""
        self._given_up = self.probing
        if self.probing and report.caught is not None:
            return  # the backend brakes already
        at = self.feeder.brake(report.executed, latency)
        self.feeder.dark_until = np.inf
        self._take_back(at)

    def resume(self, report: Report, *, feed: float, rapid: float) -> float:
        """Go on at these overrides, after a hold backing up to where a beam is to relight.

        Returns the plan time when that is made up.
        """
        if self.waiting is not None:
            self._pass()
            self._scale(self.feeder.sent, feed, rapid)
            return 0.0
        now = max(self.feeder.plan_time(report.executed), self.feeder.end)
        self._scale(now, feed, rapid)
        back = self.feeder.live.resume(now, relight=self._machine.beam is not None and not self.options.dark)
        self._progress.resume(now)
        self.feeder.sent, self.feeder.lit_from, self.feeder.dark_until = now, back, back + ROW
        return back

    def reverse(self, report: Report, way: float) -> None:
        """Go back along the path by a way [mm], dark, at most to where the program switched something last.

        Raises
        ------
        LocalProtocolError
            When the program waits, instead of being held.
        """
        if self.waiting is not None or not self.feeder.live.held:
            raise LocalProtocolError("the program waits here, it is not held", hint="Resume it, hold it, reverse.")
        now = max(self.feeder.plan_time(report.executed), self.feeder.end)
        switched = self._actions[self._next - 1].at if self._next else 0
        self.feeder.live.back_up(now, way, earliest=int(np.searchsorted(self._moves, switched)))
        self._progress.reverse(now)
        self.feeder.sent, self.feeder.lit_from, self.feeder.dark_until = now, np.inf, np.inf

    def override(self, report: Report, latency: float, *, feed: float, rapid: float) -> None:
        """Change the overrides as soon as an order can act."""
        at = self.feeder.soonest(report.executed, latency)
        if self._scale(at, feed, rapid):
            self.feeder.replan(at)
            self._take_back(at)

    def place(self, report: Report) -> tuple[int, float]:
        """Return the line executed and how far along the program's time [s], which falls on a way back."""
        return report.line, self._progress.at(self.feeder.plan_time(report.executed))

    def point(self, report: Report) -> dict[str, float]:
        """Return what the journal is told of the place executed: move of the program, way along its line [mm]."""
        t = self.feeder.plan_time(report.executed)
        row, distance = self.feeder.live.along(max(t, 0.0))
        move = int(self._moves[min(row, len(self._moves) - 1)]) if len(self._moves) else 0
        if self.entry is not None:
            distance = distance if move >= self.entry.way else 0.0
            move = self.entry.original(move)
        return {"move": move, "distance": round(distance, 6), "done_s": self._progress.at(t)}

    # -- inside

    def _pass(self) -> None:
        """Go beyond the action it waits at: everything before it has been set at its rest."""
        self._next += self.waiting is not BLOCK_END
        self.waiting = None
        self.feeder.until = np.inf

    def _probed(self, report: Report) -> Event | None:
        """Return CONTACT at rest after the probing move, STILL where it was given up."""
        if not (report.still and (report.caught is not None or self.feeder.done(report.executed))):
            return None
        return Event.STILL if self._given_up else Event.CONTACT

    def _scale(self, at: float, feed: float, rapid: float) -> bool:
        """Change the overrides from a plan time on; False where they are the same."""
        speeds = self.feeder.live.speeds
        if (speeds.feed, speeds.rapid) == (feed, rapid):
            return False
        self.feeder.live.override(at, feed=feed, rapid=rapid)
        return True

    def _take_back(self, at: float) -> None:
        """Forget the actions and the pause that were sent for plan times from ``at`` on."""
        while self._sent and self._sent[-1][0] >= at:
            _, self._next = self._sent.pop()
        if self.waiting is not None and self._paused_at is not None and self._paused_at >= at:
            self.waiting = None
            self.feeder.until = np.inf

    def _until(self, portions: list[Portion]) -> float | None:
        """Return the plan time of the first pause in portions to be sent, or None."""
        number = next((k for k in range(self._next, len(self._actions)) if self._waits(self._actions[k])), None)
        waits = len(self.plan.program.moves) + 1 if number is None else self._actions[number].at
        for t, reached in self._reached(portions):
            action = self._actions[number] if reached >= waits and number is not None else None
            line = self._line(reached)
            fresh = self.by_block and line not in {self._block, None}
            if fresh and self._block is not None and (action is None or isinstance(action, Probe)):
                return self._pause(t, BLOCK_END)
            if action is not None:
                return self._pause(t, action)
            if fresh:
                self._block = line
        return None

    def _pause(self, t: float, action: Action) -> float:
        self.waiting, self._paused_at, self._block = action, t, None
        self.feeder.until = t
        return t

    def _line(self, move: int) -> int | None:
        """Return the source line of a move; None after the last."""
        moves = self.plan.program.moves
        return int(moves["line"][move]) if move < len(moves) else None

    def _waits(self, action: Action) -> bool:
        if isinstance(action, Pause):
            return not action.optional or self.options.optional_stop
        if isinstance(action, UserCode):
            return not self.options.dark
        return isinstance(action, ToolChange | Probe)

    def _reached(self, portions: list[Portion]) -> Iterator[tuple[float, int]]:
        """Yield (plan time, move) at the start of each phase: actions that stand at or before the move are due then."""
        for part in portions:
            if part.backwards:
                continue  # what stands there was done on the way out
            rests = part.phases["flags"] & REST == REST
            rows = part.phases["segment"].astype(np.int64) + part.first
            for t, row, s, rest in zip(part.phases["t"], rows, part.phases["s"], rests, strict=True):
                number = row + 1 if rest and s > 0.0 else row
                yield float(t), int(self._moves[number]) if number < len(self._moves) else len(self.plan.program.moves)

    def _timed(self, portions: list[Portion]) -> Iterator[tuple[float, str, float]]:
        """Yield what is set along portions that are being sent: (stream time, output, value)."""
        for t, reached in self._reached(portions):
            while self._next < len(self._actions) and self._actions[self._next].at <= reached:
                action = self._actions[self._next]
                if self._waits(action):
                    break
                yield from ((self.feeder.origin + t, name, value) for name, value in self.doings.sets(action))
                self._sent.append((t, self._next))
                self._next += 1
