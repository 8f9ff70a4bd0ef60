"""Steps of a program as spans for a board that drives windings itself.

In: steps and releases of two motors in order of time.  Out: spans, each with as many steps of both motors as one
polynomial of each can make within 10 µs of their times.  Times are kept to the program's: errors do not add up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trochia.backends.avr.windings import bits
from trochia.kernels.link import AT_REST, PART, SET_OUTPUTS, SPAN, fit_one
from trochia.kernels.ticks import BACKWARDS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

CLOCK = 16_000_000
LEAD = 4000  #: ticks before the first step
TOLERANCE = 160.0  #: of a step: 10 µs [ticks]
SOON = 64  #: ticks from a span's begin to its first step at least; a release takes as many
SLEW = 0xFFFF  #: such a motor stops within a step


class Event(NamedTuple):
    """A step of a motor in a way of excitation, or with direction 0 its release."""

    moment: float
    motor: int
    direction: int
    style: int | None


class Spans:
    """Spans of one stretch of motion, that begins with an event at ``begin`` [s]."""

    def __init__(self, begin: float) -> None:
        self.begin = begin
        self._at = 0  # where the last span ends [ticks]
        self._number = 0
        self._styles: list[int | None] = [None, None]

    def made(self, events: Sequence[Event]) -> Iterator[bytes]:
        """Return the spans of the events that come next."""
        first = 0
        while first < len(events):
            ways: dict[int, tuple[int, int | None]] = {}
            after = first
            while after < len(events) and ways.setdefault(events[after].motor, events[after][2:]) == events[after][2:]:
                after += 1
                if not events[after - 1].direction:
                    break
            yield from self._block(events[first:after], ways)
            first = after

    def at_rest(self) -> bytes:
        """Return the span that ends it all."""
        return self._span(SOON, {}, AT_REST)

    def _block(self, events: Sequence[Event], ways: dict[int, tuple[int, int | None]]) -> Iterator[bytes]:
        """Return spans of events in which no motor turns round or is excited otherwise; a release stands alone."""
        left = {
            motor: np.array([round((event.moment - self.begin) * CLOCK) + LEAD for event in events
                             if event.motor == motor], np.int64)
            for motor, (direction, _) in ways.items() if direction
        }  # fmt: skip
        released = [(motor, event.moment) for motor, event in ((e.motor, e) for e in events) if not event.direction]
        for motor in left:
            self._styles[motor] = ways[motor][1]
        while any(ticks.size for ticks in left.values()):
            parts: dict[int, tuple[Any, NDArray[np.int64]]] = {}
            for motor, ticks in left.items():
                if ticks.size:  # times are the fit's from here on, which lie within its tolerance of what is wanted
                    soonest = SOON * np.arange(1, ticks.size + 1)
                    parts[motor] = fit_one(np.maximum(ticks - self._at, soonest), TOLERANCE)
            short = [made for motor, (_, made) in parts.items() if made.size < left[motor].size]
            whole = [made for motor, (_, made) in parts.items() if made.size == left[motor].size]
            end = self._at + 1 + (min(int(made[-1]) for made in short) if short else max(int(m[-1]) for m in whole))
            chosen: dict[int, Any] = {}
            for motor, (part, made) in parts.items():
                count = int(np.searchsorted(made, end - self._at))
                left[motor] = left[motor][count:]
                if count:
                    part["count"] = count - 1
                    part["flags"] |= BACKWARDS if ways[motor][0] < 0 else 0
                    chosen[motor] = part
            yield self._span(end - self._at, chosen)
        for motor, moment in released:
            self._styles[motor] = None
            yield self._span(max(round((moment - self.begin) * CLOCK) + LEAD - self._at, 0) + SOON, {})

    def _span(self, duration: int, parts: dict[int, Any], flags: int = 0) -> bytes:
        """Return a span of as many ticks."""
        head = np.zeros((), SPAN)
        head["number"], head["slew"], head["outputs"] = self._number & 0xFFFF, SLEW, bits(self._styles)
        head["flags"], head["duration"] = SET_OUTPUTS | flags, duration
        head["motors"] = sum(1 << motor for motor in parts)
        self._at, self._number = self._at + duration, self._number + 1
        return head.tobytes() + b"".join(parts[motor].astype(PART).tobytes() for motor in sorted(parts))
