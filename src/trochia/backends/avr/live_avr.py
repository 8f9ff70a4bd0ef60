"""The firmware as a live backend: orders in, reports out, a board or its image in between.

In: segments by stream time, kept in a queue like the twin's and sent as spans as the chip has room.  Out: reports of
what the chip says it has *executed*: stream time by its own clock, and steps counted at the pins.  The position told is
the plan's at that stream time; at rest the steps are held against it.
"""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from trochia.backends.avr.clock import ChipClock
from trochia.backends.avr.inputs import Inputs
from trochia.backends.avr.session import Greeted, Session, Told
from trochia.backends.avr.spans import SpanMaker, shortened, steps_made
from trochia.backends.avr.transports import Transport, first_number, unanswered
from trochia.backends.avr.troubles import TROUBLES
from trochia.backends.avr.wiring import BOARDS, steps_per_unit, wire
from trochia.backends.live import BUILT_IN, Orders, Report, Trouble
from trochia.backends.queue import Queue
from trochia.errors import LimitError, LinkError, LocalProtocolError, RemoteProtocolError
from trochia.kernels.link import BEGIN, CAUSES, CUT, FULL_RATE, RUNNING, STATES
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.backends.avr.spans import Span
    from trochia.backends.live import Watch
    from trochia.machine.machine import Machine

CONNECT = 3.0  #: a board may take that long to answer after its reset [s]
ASKED = 0.0035  #: before the end of a poll a status is asked for [s]
QUIET = 0.003  #: before that nothing is sent, so that the question comes at its time [s]
KEPT = 0.2  #: how long rows that were run through are kept [s]
FILLED = 0.15  #: what the chip holds before it starts, where there is as much [s]


class LiveAvr:
    """One board.

    Parameters
    ----------
    transport
        How to reach it.
    board
        A name of :data:`trochia.backends.avr.wiring.BOARDS`.

    Raises
    ------
    ConfigError
        When the machine has more joints or channels than the board, or joints that are no steppers.
    """

    kind: ClassVar[str] = "avr"

    def __init__(self, machine: Machine, transport: Transport, *, board: str = "uno-stepdir") -> None:
        self.machine, self.board = machine, BOARDS[board]
        self.latency, self.ahead, self.lag = 0.02, 0.4, 0.01  # lag: a chip at its limit answers late
        self._scale = steps_per_unit(machine, self.board.motors)
        self.wiring = wire(machine, self.board)
        self._full = machine.beam.full_power if machine.beam else 1.0
        self._names = [joint.name for joint in machine.joints]
        self.outputs = dict.fromkeys((*BUILT_IN, *self.wiring.outputs), 0.0)
        self.transport = transport
        self.session = Session(transport.baud, seed=first_number(transport))
        self.clock = ChipClock(16_000_000)
        self.answer: Any = None
        self.status: Any = None
        self.inputs = Inputs(self)
        self._queue = Queue(np.zeros(len(self._names)))
        self._maker = SpanMaker(self._scale, 16_000_000, self._level, self.board.closest)
        self._spans: list[Span] = []
        self._now = self._asked = 0.0
        self._executed = self._rate = self._stamp = 0.0
        self._epoch, self._state = 0, "idle"  # idle, loading, running
        self._enabled = self._stopping = False
        self._begun = self._looked = -1
        self._timed: list[tuple[float, str, float]] = []
        self._watch: tuple[Watch, ...] = ()
        self._caught: tuple[str, NDArray[np.float64]] | None = None
        self._troubles: list[Trouble] = []

    def open(self, now: float) -> Report:
        """Connect; see :class:`trochia.backends.live.SegmentBackend`.

        Raises
        ------
        LinkTimeout
            When nothing answers.
        VersionMismatch
            When the image belongs to another program.
        RemoteProtocolError
            When it is an image for another board.
        """
        self._now = now
        for name, (_, active) in self.wiring.inputs.items():
            self.inputs.put(name, level=1 - active)
        self.session.greet(now)
        while self.answer is None:
            self._breathe()
            if self._now - now > CONNECT:
                raise unanswered(self.transport, self.session.strange)
        while (self.status is None or self.status["state"] == RUNNING) and self._now - now < CONNECT:
            self.session.ask()  # a board that was not reset brakes first
            self._asked = self._now
            self._breathe()
        if self.status is not None:
            self._queue.clear(self._positions() / self._scale, self._executed)
        self._now = now
        self.transport.rebase(now)
        self.clock = ChipClock(int(self.answer["clock"]))
        return self._report(now)

    def close(self) -> None:
        """Stop, drives off, disconnect."""
        self.session.halt(drives_off=True)
        with suppress(LinkError):  # nobody is there any more
            self._exchange(self._now + 0.005)
        self.transport.close()

    def poll(self, now: float) -> Report:
        """Let time go on to ``now``, and report; see :class:`trochia.backends.live.SegmentBackend`."""
        stride = self.transport.stride
        ask_at = max(now - ASKED, self._now)
        asked = False
        quiet = ask_at - QUIET if stride and ask_at - self._now > 2 * QUIET else now + 1.0
        while True:
            if self._now < quiet:
                self._send()
            if not asked and self._now >= ask_at - 1e-9:
                asked, self._asked = True, self._now
                self.session.ask()
            to = min(self._now + stride, now if asked else ask_at) if stride else now
            self._exchange(max(to, self._now))
            if self._now >= now - 1e-9 and asked:
                break
        return self._report(now)

    def order(self, orders: Orders, now: float) -> None:  # noqa: ARG002 - the clock is told by poll
        """Take orders; see :class:`trochia.backends.live.SegmentBackend`."""
        self._check(orders)
        if orders.stop or orders.enable is False:
            self._halt(drives_off=orders.enable is False)
        self._switch(orders)
        if orders.watch is not None:
            self._look(orders.watch)
        if orders.place:
            self._place(orders.place)
        stale = self._caught is not None and orders.watch is None
        if orders.segments is not None and not stale:
            if not self._enabled:
                raise LocalProtocolError("segments for drives that are off")
            self._queue.add(orders.segments, orders.at, self._executed)
            self._timed = [entry for entry in self._timed if entry[0] < orders.at]
            self._cut(orders.at)
        for at, _, _ in orders.timed:
            self._cut(at)
        self._timed = sorted([*self._timed, *orders.timed])

    def _check(self, orders: Orders) -> None:
        for name in (*orders.outputs, *(name for _, name, _ in orders.timed)):
            if name not in self.outputs:
                raise LocalProtocolError(f"there is no output {name!r}", hint=f"There are: {', '.join(self.outputs)}")

    def _level(self, power: float) -> int:
        return round(255 * min(max(power / self._full, 0.0), 1.0))

    def _switch(self, orders: Orders) -> None:
        """Put drives, light and outputs, at once."""
        if orders.enable is not None:
            self._enabled = orders.enable
        self.outputs |= orders.outputs
        if orders.enable is not None or orders.lit is not None or orders.outputs:
            self.session.order("switch", self.wiring.put(orders, self.outputs))

    def _look(self, watch: tuple[Watch, ...]) -> None:
        self._watch, self._caught = watch, None
        self._looked = self.session.order("watch", self.wiring.look(watch))

    def _place(self, names: Mapping[str, float]) -> None:
        """Call the joints' present positions by other numbers."""
        if self._state != "idle" or self._moving:
            raise LocalProtocolError("positions are named at rest only")
        commanded = self._commanded()
        for name, value in names.items():
            i = self._names.index(name)
            self._maker.offset[i] += value - commanded[i]
            commanded[i] = value
        self._queue.clear(commanded, self._executed)

    def _halt(self, *, drives_off: bool) -> None:
        """Stand still at once: what is queued is gone."""
        self.session.forget()
        self.session.halt(drives_off=drives_off)
        self._timed.clear()
        self.outputs |= dict.fromkeys(BUILT_IN, 0.0)
        if self._state == "idle":
            self._rest_at(self._executed)
        else:
            self._stopping = True

    @property
    def _moving(self) -> bool:
        return len(self._queue.held) > 0 and self._queue.end > self._executed + 1e-9

    def _cut(self, at: float) -> None:
        """Take back spans from a stream time on; they are made anew."""
        tick = self._maker.tick(at)
        if self._state == "idle" or not self._spans or tick >= self._maker.at:
            return
        while self._spans and self._spans[-1].start >= tick and len(self._spans) > 1:
            self._spans.pop()
        span, cut = self._spans[-1], np.zeros((), CUT)
        if span.start >= tick:  # all of them
            self._spans.pop()
            self._maker.back_to(span.start, span.number, span.before)
            cut["number"] = span.number
        else:
            self._spans[-1] = shorter = shortened(span, tick)
            self._maker.back_to(shorter.end, span.number + 1, shorter.before + steps_made(shorter))
            cut["number"], cut["duration"] = span.number, tick - span.start
        self.session.order("cut", cut.tobytes())

    def _send(self) -> None:
        """Make and send spans as long as the chip has room, and start it when it holds enough."""
        if self._stopping or not self._enabled or self._caught is not None:
            return
        if self._state == "idle":
            if not self._moving:
                return
            self._begin()
        largest = self._maker.payload
        while self.session.room >= largest and self.session.waiting < 3:
            boundaries = [self._maker.tick(at) for at, _, _ in self._timed]
            if not self._worth():
                break
            try:
                span = self._maker.make(self._queue, boundaries, self._outputs_at)
            except LimitError:
                self._halt(drives_off=False)
                self._troubles.append(Trouble(cause=Cause.OVER_SPEED))
                return
            if span is None:
                break
            self._spans.append(span)
            self.session.order("span", span.payload)
        if self._state == "loading":
            held = self._maker.time(self._maker.at)
            enough = held - self._executed >= FILLED or self._maker.at >= self._maker.tick(self._queue.end)
            if enough or self.session.room < largest:
                self.session.order("go")
                self._state = "running"

    def _worth(self) -> bool:
        """Whether to make a span now: a short one only where nothing longer is to come, or it is urgent."""
        left = self._queue.end - self._maker.time(self._maker.at)
        held = self._maker.time(self._maker.at) - self._executed
        return left > 0.03 or self._queue.ends_at_rest or held < 0.15

    def _begin(self) -> None:
        self._epoch = self._epoch % 255 + 1
        order = np.zeros((), BEGIN)
        order["epoch"] = self._epoch
        self._begun = self.session.order("begin", order.tobytes())
        self._spans.clear()
        self._maker.restart(self._executed)
        self._state = "loading"

    def _outputs_at(self, tick: int) -> int:
        due = {name: value for at, name, value in self._timed if self._maker.tick(at) <= tick}
        return self.wiring.levels(self.outputs | due)

    def _breathe(self) -> None:
        """Let two thousandths of a second pass."""
        self._exchange(self._now + 0.002)
        if not self.transport.stride:
            time.sleep(0.002)

    def _exchange(self, now: float) -> None:
        """Let bytes pass until ``now``."""
        came = self.transport.exchange(self.session.outgoing(self._now), now)
        self._now = now
        for event in self.session.receive(came, now):
            if isinstance(event, Greeted):
                self._greeted(event.answer)
            elif isinstance(event, Told):
                self._told(event)
            else:
                self._troubles.append(Trouble(cause=Cause.LINK, value=event.silence))

    def _greeted(self, answer: Any) -> None:  # noqa: ANN401 - a numpy record has no type of its own
        name = bytes(answer["board"]).rstrip(b"\0").decode("ascii", "replace")
        if name != self.board.name:
            raise RemoteProtocolError(f"the board is {name}, not {self.board.name}", hint=f"Say --board {name}.")
        self.answer, self._maker.payload = answer, int(answer["payload"])

    def _told(self, told: Told) -> None:
        status = told.status
        self.status = status
        at = self.clock.sample(self._asked, told.time, int(status["clock"]))
        state = STATES.get(int(status["state"]), "stopped")
        if self._state == "idle":
            if not self._spans:
                self._maker.count = self._positions()
            return
        if int(status["epoch"]) != self._epoch or told.taken <= self._begun:
            return
        ticks = int(status["executed"])
        self._executed, self._stamp = min(self._maker.time(ticks), self._queue.end), at
        self._rate = int(status["rate"]) / FULL_RATE if state == "running" else 0.0
        if int(status["caught"]) and told.taken > self._looked and self._caught is None:
            self._catch(int(status["caught"]), int(status["caught_at"]))
        if state == "stopped":
            self._stopped(CAUSES.get(int(status["cause"]), ""))
        elif state == "idle" and self._state == "running" and ticks >= self._maker.at and not self.session.waiting:
            self._ended()
        elif state == "idle" and not self.session.waiting and self._state == "running":
            self._maker.count = self._positions()  # it ended before what was sent late came: go on from there
            self._state = "idle"

    def _positions(self) -> NDArray[np.int64]:
        return np.array(self.status["position"][: len(self._names)], np.int64)

    def _catch(self, bits: int, ticks: int) -> None:
        for watched in self._watch:
            if bits >> self.wiring.inputs[watched.name][0] & 1:
                where = self._queue.at(np.array([self._maker.time(ticks)])).position[0]
                self._caught = (watched.name, where)
                return

    def _ended(self) -> None:
        """Note that the chip has run through all it was given."""
        self._state = "idle"
        self._executed = max(self._executed, min(self._queue.end, self._executed + 2.0 / self._maker.clock))
        self._compare(self._maker.count)

    def _stopped(self, cause: str) -> None:
        """Note that the chip has stopped, by itself or as it was told: what it held is gone."""
        self.session.forget()
        self._stopping = False
        if cause in TROUBLES:
            self._troubles.append(Trouble(cause=TROUBLES[cause]))
        if cause == "estop":
            self._enabled = False
        self._compare((self._commanded() - self._maker.offset) * self._scale)
        self._rest_at(self._executed)

    def _rest_at(self, executed: float) -> None:
        self._queue.clear(self._queue.at(np.array([executed])).position[0], executed)
        self._timed = []
        self._spans.clear()
        self._state = "idle"

    def _compare(self, wanted: NDArray[Any]) -> None:
        """Hold the steps that were made against those there should be."""
        made = self._positions()
        for j in np.flatnonzero(np.abs(made - wanted) > 1.0):
            self._troubles.append(
                Trouble(cause=Cause.FOLLOWING, joint=self._names[j],
                        value=float(abs(made[j] - wanted[j]) / self._scale[j]), limit=float(1.0 / self._scale[j]))
            )  # fmt: skip
        self._maker.count = made

    def _commanded(self) -> NDArray[np.float64]:
        return self._queue.at(np.array([self._executed])).position[0]

    def _report(self, now: float) -> Report:
        """Return how things stand, carried on from the last status to now."""
        running = self._state == "running" and self._moving
        if running and self._rate > 0.0:
            on = self._rate * min(max(now - self._stamp, 0.0), 0.01)
            held = self._maker.time(self._maker.at)
            self._executed = max(self._executed, min(self._executed + on, held, self._queue.end))
            self._stamp = max(now, self._stamp)
        moving, rate = self._moving, self._rate if running else 0.0
        for at, name, value in self._timed:
            if at <= self._executed + 1e-9:
                self.outputs[name] = value
        self._timed = [entry for entry in self._timed if entry[0] > self._executed + 1e-9]
        sample = self._queue.at(np.array([self._executed]))
        held = self._queue.held
        self._queue.forget(self._executed - KEPT if moving else self._executed)
        self._spans = [span for span in self._spans if self._maker.time(span.end) > self._executed - KEPT]
        troubles, self._troubles = tuple(self._troubles), []
        status = self.status
        return Report(
            time=now, executed=self._executed, rate=rate, queued=self._queue.end - self._executed if moving else 0.0,
            commanded=sample.position[0], velocity=sample.velocity[0] * rate, encoder=None, actual=None,
            enabled=self._enabled, beam=int(status["beam"]) / 255 * self._full if rate >= 1.0 else 0.0,
            line=int(held.line[int(sample.row[0])]) if len(held) else 0,
            inputs=self.inputs.levels(), outputs=dict(self.outputs), troubles=troubles, caught=self._caught,
        )  # fmt: skip
