"""The firmware as a live backend: orders in, reports out, a board or its image in between.

In: segments by stream time, kept in a queue like the twin's and sent as spans as the chip has room.  Out: reports of
what the chip says it has *executed*: stream time by its own clock, and steps counted at the pins.  The position told is
the plan's at that stream time; at rest the steps are held against it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from trochia.backends.avr.clock import ChipClock
from trochia.backends.avr.connection import Connection
from trochia.backends.avr.inputs import Inputs
from trochia.backends.avr.spans import SpanMaker, shortened, steps_made
from trochia.backends.avr.troubles import TROUBLES
from trochia.backends.avr.wiring import BOARDS, steps_per_unit, wire
from trochia.backends.live import BUILT_IN, Orders, Report, Trouble, check_outputs
from trochia.backends.queue import Queue
from trochia.errors import LimitError, LinkError, LocalProtocolError
from trochia.kernels.link import BEGIN, CAUSES, CUT, FULL_RATE, STATES
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from trochia.backends.avr.session import Told
    from trochia.backends.avr.spans import Span
    from trochia.backends.avr.transports import Transport
    from trochia.backends.live import Watch
    from trochia.machine.machine import Machine

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
        self.ahead, self.lag = 0.4, 0.01  # lag: a chip at its limit answers late
        self._scale = steps_per_unit(machine, self.board.motors)
        self.wiring = wire(machine, self.board)
        self._full = machine.beam.full_power if machine.beam else 1.0
        self._names = [joint.name for joint in machine.joints]
        self.outputs = dict.fromkeys((*BUILT_IN, *self.wiring.outputs), 0.0)
        self.link = Connection(transport, self.board)
        self.transport, self.session, self.latency = transport, self.link.session, self.link.latency
        self.title, self.bound = f"{board} {transport.place}", (board, transport.baud)
        self.clock = ChipClock(16_000_000)
        self.inputs = Inputs(self)
        self._queue = Queue(np.zeros(len(self._names)))
        self._maker = SpanMaker(self._scale, 16_000_000, self._level, self.board.closest)
        self._spans: list[Span] = []
        self._executed = self._rate = self._stamp = 0.0
        self._epoch, self._state = 0, "idle"  # idle, loading, running
        self._gone, self._seen_epoch = False, 0  # whether it was lost and is not back; of the board's last status
        self._enabled = self._stopping = False
        self._begun = self._looked = -1
        self._timed: list[tuple[float, str, float]] = []
        self._watch: tuple[Watch, ...] = ()
        self._caught: tuple[str, NDArray[np.float64]] | None = None
        self._troubles: list[Trouble] = []
        self._line = 0  # executed last

    def open(self, now: float) -> Report:
        """Connect; see :class:`trochia.backends.live.SegmentBackend`.

        Raises
        ------
        LinkTimeout
            When nothing answers.
        VersionMismatch, RemoteProtocolError
            When the image belongs to another program, or to another board.
        """
        for name, (_, active) in self.wiring.inputs.items():
            self.inputs.put(name, level=1 - active)
        self.link.open(now, estop=self.wiring.stops(self.machine.panel))
        self._maker.count = self._met()
        self._queue.clear(self._maker.count / self._scale, self._executed)
        self._seen_epoch = int(self.status["epoch"])
        return self._report(now)

    @property
    def status(self) -> Any:  # noqa: ANN401 - a numpy record has no type of its own
        """What the board said of itself last."""
        return self.link.status

    def close(self) -> None:
        """Stop, drives off, disconnect."""
        self.link.close()

    def poll(self, now: float) -> Report:
        """Let time go on to ``now``, and report; see :class:`trochia.backends.live.SegmentBackend`."""
        link, stride = self.link, self.transport.stride
        ask_at = max(now - ASKED, link.now)
        asked = False
        quiet = ask_at - QUIET if stride and ask_at - link.now > 2 * QUIET else now + 1.0
        while True:
            if link.now < quiet and not link.lost:
                self._send()
            if not asked and link.now >= ask_at - 1e-9:
                asked = True
                link.ask()
            to = min(link.now + stride, now if asked else ask_at) if stride else now
            self._exchange(max(to, link.now))
            if link.now >= now - 1e-9 and asked:
                break
        return self._report(now)

    def order(self, orders: Orders, now: float) -> None:
        """Take orders; see :class:`trochia.backends.live.SegmentBackend`."""
        check_outputs(orders, self.outputs)
        if self.link.lost:
            if orders.enable or orders.segments is not None:
                raise LinkError(self.link.lost, hint="Is the cable in?")
            return  # it stands still, or does soon, and its drives are switched off when it is back
        if orders.stop or orders.enable is False:
            self._halt(drives_off=orders.enable is False)
        self._switch(orders)
        if orders.watch is not None:
            self._look(orders.watch)
        if orders.place:
            self._place(orders.place)
        self.inputs.set(orders.inputs)
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
        if not self.transport.stride:
            self._send()
            self._exchange(now)  # a turn later the chip may have run through what is to be replaced

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
            except LimitError as error:
                self._halt(drives_off=False)
                self._troubles.append(Trouble(cause=Cause.OVER_SPEED, text=error.message))
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

    def _exchange(self, now: float) -> None:
        """Let bytes pass until ``now``."""
        for told in self.link.exchange(now):
            self._gone = self._gone and not self._back()
            self._told(told)
        if self.link.lost and not self._gone:
            self._lose()

    def _met(self) -> NDArray[np.int64]:
        """Go by what the board's answer says of it, and return where its motors stand (motors,) [steps]."""
        answer = self.link.answer
        self.clock, self._maker.payload = ChipClock(int(answer["clock"])), int(answer["payload"])
        return self._positions()

    def _lose(self) -> None:
        """Note that nobody hears the board: it brakes by itself, and what it was to do is forgotten."""
        self._gone, self._rate, self._enabled, self._stopping = True, 0.0, False, False
        self._watch, self._caught, self._looked = (), None, -1
        self._rest_at(self._executed)

    def _back(self) -> bool:
        """Take up with a board that is back: it knows where it stands, unless it was reset, and moves for nobody."""
        self._enabled = bool(self.status["enabled"])
        self.outputs = dict.fromkeys(self.outputs, 0.0)
        self._switch(Orders(lit=False, outputs=self.outputs))
        count = self._met()
        if self._seen_epoch and not int(self.status["epoch"]):  # it was reset: it counts from 0 again
            self._maker.offset = self._commanded() - count / self._scale
        self._maker.count = count
        self._queue.clear(count / self._scale + self._maker.offset, self._executed)
        return True

    def _told(self, told: Told) -> None:
        status = told.status
        self._seen_epoch = int(status["epoch"])
        at = self.clock.sample(self.link.asked, told.time, int(status["clock"]))
        state = STATES.get(int(status["state"]), "stopped")
        self.inputs.look(self._positions() / self._scale)
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
            self._troubles.append(TROUBLES[cause])
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
        self._line = int(self._queue.held.line[int(sample.row[0])]) if len(self._queue.held) else self._line
        self._queue.forget(self._executed - KEPT if moving else self._executed)
        self._spans = [span for span in self._spans if self._maker.time(span.end) > self._executed - KEPT]
        troubles, self._troubles = tuple(self._troubles), []
        if self.link.lost:
            troubles += (Trouble(cause=Cause.LINK, text=self.link.lost),)
        status = self.status
        return Report(
            time=now, executed=self._executed, rate=rate, queued=self._queue.end - self._executed if moving else 0.0,
            commanded=sample.position[0], velocity=sample.velocity[0] * rate, encoder=None, actual=None,
            enabled=self._enabled, beam=int(status["beam"]) / 255 * self._full if rate >= 1.0 else 0.0,
            line=self._line, inputs=self.inputs.levels(), outputs=dict(self.outputs), troubles=troubles,
            caught=self._caught, settable=bool(self.transport.stride),
        )  # fmt: skip
