"""A session with a chip over a line that goes wrong: it ends in the very motion that was sent, or in an alarm with
the true position; anything else is an AssertionError.

Case N is made from seed N alone: motors, spans, whether it is held on the way, whether the host is started anew, and
what is done to the line where.  The host's end is the package's own session; the chip's is the firmware, simulated or
compiled for this computer.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.avr.session import Greeted, Lost, Session, Told
from trochia.kernels.link import BEGIN, CAUSES, PUT, STATES

if TYPE_CHECKING:
    from pathlib import Path

_spans, _lines = sys.modules["random_spans"], sys.modules["spoilt_line"]

TURN = 0.002  #: of the host [s]
ASKED = 0.01  #: between questions [s]
GIVES_UP = 0.3  #: after the line was lost it is tried anew [s]
PATIENCE = 3.0  #: longest a motion may take beyond its time; a line that is lost for good is joined before [s]
STEPS, WAYS = ("D2", "D3", "D4", "B4"), ("D5", "D6", "D7", "B5")
STYLES = ("one", "two", "hello", "hold", "reconnect", "rate", "bursts")
SLACK = 4096  #: ticks of stream time within which a step and the place it stopped at are told apart: a slice, braking


@dataclass(slots=True)
class Told_:  # noqa: N801 - `Told` is the session's
    """How a case ended: of each motion ``same`` or its alarm; how many faults there were."""

    ends: list[str] = field(default_factory=list)
    faults: int = 0
    bytes: tuple[int, int] = (0, 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One session: two motions, faults on the line, and when they happen."""

    seed: int
    kind: Any
    counts: tuple[int, ...]
    hold: float | None = None
    anew: bool = False
    start: tuple[Any, ...] = ()
    at_hold: tuple[Any, ...] = ()
    at_reconnect: tuple[Any, ...] = ()
    rate: float = 0.0


def case_of(seed: int, style: str | None = None) -> Case:
    """Return the case of a seed."""
    rng = np.random.default_rng(seed)
    style = style or STYLES[int(rng.integers(len(STYLES)))]
    kind = _spans.Kind(motors=int(rng.integers(1, 4)), fastest=12_000.0, ticks=(1 << 16, 1 << 18))
    counts = (int(rng.integers(6, 22)), int(rng.integers(3, 8)))
    hold = float(rng.uniform(0.0, 0.2)) if style == "hold" or rng.random() < 0.2 else None
    anew = style == "reconnect" or rng.random() < 0.2
    start: tuple[Any, ...] = ()
    if style in {"one", "two"}:
        start = tuple(fault(rng, 2500) for _ in range(1 + (style == "two")))
    elif style in {"hello", "reconnect"}:
        start = tuple(fault(rng, 60) for _ in range(int(rng.integers(1, 3))))
    elif style == "bursts":
        start = tuple(fault(rng, 2500, "burst") for _ in range(int(rng.integers(3, 30))))
    near = tuple(fault(rng, 80) for _ in range(int(rng.integers(1, 3))))
    return Case(
        seed=seed, kind=kind, counts=counts, hold=hold, anew=anew, start=start,
        at_hold=near if style == "hold" else (), at_reconnect=near if style == "reconnect" else (),
        rate=10 ** rng.uniform(-3.0, -1.3) if style == "rate" else 0.0,
    )  # fmt: skip


def fault(rng: np.random.Generator, within: int, kind: str = "") -> Any:
    """Draw a fault within so many bytes."""
    kind = kind or _lines.KINDS[int(rng.integers(len(_lines.KINDS)))]
    size = float(rng.integers(8))
    if kind == "burst":
        size = float(rng.integers(2, 200))
    elif kind in {"delay", "cut"}:
        size = _lines.ALWAYS if kind == "cut" and rng.random() < 0.3 else float(10 ** rng.uniform(-2.5, 0.2))
    return _lines.Fault(kind=kind, way=int(rng.integers(2)), at=int(rng.integers(within)), size=size)


class Run:
    """A case being run.

    Parameters
    ----------
    transport
        A ``ChipTransport`` whose ``edges`` are kept.
    """

    def __init__(self, case: Case, transport: Any) -> None:
        transport.edges = []
        self.case, self.chip = case, transport
        self.line = _lines.SpoiltLine(transport, case.seed, faults=case.start, rate=case.rate)
        self.now, self.asked, self.epoch = 0.0, 0.0, 0
        self.ended = Told_()
        self.position = np.zeros(len(STEPS), np.int64)
        self.before = np.zeros(len(STEPS), np.int64)  # steps seen at the pins already
        self.session = self.meet(new=True)

    def meet(self, *, new: bool) -> Session:
        """Say hello until there is an answer; a line that is cut for good is joined after a while."""
        if new:
            self.session = Session(self.chip.baud, seed=int(self.line.rng.choice([0, self.line.rng.integers(256)])))
        since, self.answer, self.status, self.lost = self.now, None, None, False
        self.session.greet(self.now)
        while self.answer is None:
            self.turn()
            if self.now - since > GIVES_UP:
                self.line.mend()
            assert self.now - since < PATIENCE, "it hangs: no answer to a hello"
        return self.session

    def turn(self) -> None:
        """Let a moment pass."""
        if self.answer is not None and self.now - self.asked >= ASKED:
            self.asked = self.now
            self.session.ask()
        came = self.line.exchange(self.session.outgoing(self.now), self.now + TURN)
        self.now += TURN
        for event in self.session.receive(came, self.now):
            if isinstance(event, Greeted):
                self.answer = event.answer
            elif isinstance(event, Told):
                self.status, self.taken = event.status, event.taken
            elif isinstance(event, Lost):
                self.lost, self.since = True, self.now

    def rest(self) -> str:
        """Wait until the board says that it stands still, joining the line if need be; return its state's cause."""
        since = self.now
        self.status = None
        while True:
            self.turn()
            if self.status is not None and STATES[int(self.status["state"])] != "running":
                return CAUSES[int(self.status["cause"])]
            if self.now - since > GIVES_UP:
                self.line.mend()
            assert self.now - since < PATIENCE, "it hangs: the board does not come to rest, or does not say so"

    def switched_on(self) -> None:
        order = np.zeros((), PUT)
        order["enable"], order["lit"] = 1, 1
        self.session.order("switch", order.tobytes())

    def motion(self, count: int, *, hold: float | None) -> str:
        """Send one motion, and hold it to its law; return how it ended."""
        rng = np.random.default_rng((self.case.seed, count, self.epoch))
        spans = _spans.drawn(rng, self.case.kind, count)
        wanted = _spans.planned(spans)
        self.epoch, self.lost = self.epoch + 1, False
        order = np.zeros((), BEGIN)
        order["epoch"] = self.epoch
        self.switched_on()
        begun = self.session.order("begin", order.tobytes())
        end = self.now + wanted.stream / 16e6 + PATIENCE
        sent, started, held, last = 0, None, False, begun
        while not self._over(last if started is not None and sent == len(spans) else None, begun):
            if self.now > end:
                self.line.mend()  # nothing gets through, or next to nothing
            assert self.now < end + PATIENCE, "it hangs: neither the end nor an alarm"
            while sent < len(spans) and self.session.room >= len(spans[sent]) and self.session.waiting < 3:
                last = self.session.order("span", spans[sent])
                sent += 1
            full = sent == len(spans) or self.session.room < len(spans[sent])
            if started is None and full:
                last, started = self.session.order("go"), self.now
            if hold is not None and not held and started is not None and self.now - started > hold:
                held, last = True, self.session.order("brake")
                self.line.arm(*self.case.at_hold)
            self.turn()
            if self.lost:
                return self._broken(wanted, spans)
        return self._law(wanted, whole=sent == len(spans), told=held)

    def _over(self, last: int | None, begun: int) -> bool:
        """Whether the board has told that this motion is over."""
        status = self.status
        if status is None or self.taken <= begun or int(status["epoch"]) != self.epoch:
            return False
        state = STATES[int(status["state"])]
        return state == "stopped" or (state == "idle" and last is not None and self.taken > last)

    def _broken(self, wanted: Any, spans: list[bytes]) -> str:
        """Go on after the line was lost: a host tries again, or another is started."""
        self.line.arm(*self.case.at_reconnect)
        self.meet(new=self.case.anew)
        del spans
        return "link, " + self._law(wanted, whole=False, told=True)

    def _law(self, wanted: Any, *, whole: bool, told: bool) -> str:
        """Hold what was made against what was planned."""
        cause = self.rest()
        status = self.status
        at = np.array(status["position"][: len(STEPS)], np.int64)
        made, cycles = _spans.at_pins(np.concatenate(self.chip.edges), STEPS, WAYS)
        begun = int(status["epoch"]) == self.epoch
        for motor, (steps, cycle) in enumerate(zip(made, cycles, strict=True)):
            assert at[motor] == steps.sum(), f"motor {motor}: {at[motor]} told, {steps.sum()} made"
            mine = steps[self.before[motor] :]
            planned = wanted.steps[motor]
            assert len(mine) <= len(planned), f"motor {motor}: {len(mine)} steps, {len(planned)} planned"
            assert np.array_equal(mine, planned[: len(mine)]), f"motor {motor}: other steps than planned"
            assert len(cycle) < 2 or np.diff(cycle).min() >= 60, f"motor {motor}: steps {np.diff(cycle).min()} apart"
            assert begun or not len(mine), f"motor {motor}: {len(mine)} steps before the motion began"
            if begun:
                self._stood(motor, len(mine), wanted, int(status["executed"]))
            self.before[motor] += len(mine)
            if cause == "no_cause" and whole:
                assert len(mine) == len(planned), f"motor {motor}: {len(mine)} steps of {len(planned)}, and no alarm"
        assert not int(status["beam"]), "the beam is on at rest"
        assert cause != "ordered" or told, "stopped by order, and nobody did"
        assert cause in {"no_cause", "ordered", "silence", "low", "bad_span"}, cause
        return "same" if cause == "no_cause" else cause

    @staticmethod
    def _stood(motor: int, made: int, wanted: Any, executed: int) -> None:
        """Hold the steps a motor made against the stream time that is told."""
        ticks = wanted.ticks[motor]
        least, most = ticks.searchsorted([executed - SLACK, executed + SLACK])
        assert least <= made <= most, f"motor {motor}: {made} steps by tick {executed}, not {least} to {most}"

    def whole(self) -> Told_:
        """Run through all motions."""
        for number, count in enumerate(self.case.counts):
            self.ended.ends.append(self.motion(count, hold=self.case.hold if number == 0 else None))
            if self.case.anew:
                self.line.arm(*self.case.at_reconnect)
                self.meet(new=True)
        self.ended.faults = self.line.faults
        self.ended.bytes = (self.line.passed[0], self.line.passed[1])
        return self.ended


def run(case: Case, program: Path, image: Path) -> Told_:
    """Run a case on a chip of its own."""
    from trochia.backends.avr.transports import ChipTransport  # noqa: PLC0415 - beside what builds the chip

    transport = ChipTransport(program, image)
    try:
        return Run(case, transport).whole()
    finally:
        transport.close()
