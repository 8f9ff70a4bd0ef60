"""Whether a line brings spans as fast as they are run through, and whether a board's queue holds enough to stop in.

In: spans, one after the other.  Out: how much of what a stop takes is missing, at worst, before each has come.  A chip
brakes by itself where the slew it is allowed over all that it holds would no longer bring its rate to 0.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.kernels.link import AT_REST, FULL_RATE, SLICE, SPAN
from trochia.pulses.steps import CLOCK

if TYPE_CHECKING:
    from trochia.backends.avr.spans import Span

QUEUES = {"uno-stepdir": 600, "mega-stepdir": 1536, "uno-l293d": 512}  #: bytes
FRAMED = 6  #: bytes of a frame beside its payload
SHARE = 0.85  #: of the line that spans can have
MOST = 24_000.0  #: bytes a second: as many as may be under way, a turn of the host
TOLD = CLOCK // 200  #: ticks until the host knows that there is room: a turn of its own
FILLED = 0.15 * CLOCK  #: motion held before it starts [ticks]
AHEAD = 3 * SLICE  #: ticks by which a chip decides beforehand
IN_HAND = 0.5  #: ∫ slew · dt that a stop from full rate takes


class _Held(NamedTuple):
    start: int
    end: int
    size: int
    hand: float  # of all spans before it
    slew: float  # a tick


class Supply:
    """The line and the queue of a board.

    Parameters
    ----------
    board
        A name of :data:`QUEUES`.
    baud
        Of the line.
    """

    def __init__(self, board: str, baud: int) -> None:
        self._room = QUEUES[board]
        self._speed = min(SHARE * baud / 10.0, MOST) / CLOCK  # bytes a tick
        self._restart()

    def _restart(self) -> None:
        """Nothing is held, and nothing moves."""
        self._held: deque[_Held] = deque()  # in the queue, or so lately gone that they matter
        self._waiting: deque[_Held] = deque()  # in the queue
        self._used = 0
        self._free = 0.0  # tick at which the line is free
        self._hand = 0.0
        self._begun: int | None = None  # tick at which it began
        self._filling = True

    def add(self, span: Span) -> tuple[str, int, float]:
        """Take the next span; return what there is too little of, at which tick, and by how much (1: it just does)."""
        head = np.frombuffer(span.payload, SPAN, 1)[0]
        slew = float(head["slew"]) / FULL_RATE / SLICE
        one = _Held(span.start, span.end, len(span.payload), self._hand, slew)
        if self._begun is None:
            self._begun = one.start
        kind, came = self._arrival(one)
        missing = 0.0 if self._filling else self._missing(one, came)
        self._held.append(one)
        self._waiting.append(one)
        self._used += one.size
        self._hand += slew * (one.end - one.start)
        if int(head["flags"]) & AT_REST:
            self._restart()
        return kind, span.start, missing

    def _arrival(self, one: _Held) -> tuple[str, float]:
        """Return what a span waits for, and the tick at which it has come."""
        assert self._begun is not None
        left = -1.0
        while self._used + one.size > self._room:
            gone = self._waiting.popleft()
            self._used -= gone.size
            left = float(gone.start + TOLD)
        if self._filling and left < 0.0 and one.start - self._begun < FILLED:
            return "line", float(self._begun)
        if self._filling:
            self._filling, self._free = False, float(self._begun)
        kind, self._free = ("queue", left) if left > self._free else ("line", self._free)
        self._free += (one.size + FRAMED) / self._speed
        return kind, self._free

    def _missing(self, one: _Held, came: float) -> float:
        """Return what a stop takes by what is in hand of it just before a span comes."""
        at = came + AHEAD
        while len(self._held) > 1 and self._held[1].start <= at:
            self._held.popleft()
        now = self._held[0]
        run = now.hand + now.slew * min(max(at - now.start, 0.0), now.end - now.start)
        return IN_HAND / max(one.hand - run, 1e-3)
