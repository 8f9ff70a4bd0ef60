"""The motor shield on a board: a step program's steps are made by the chip, each at its time.

In: steps as the shield's motors make them.  Out: spans for the image ``uno-l293d``, played whenever the program rests
for a while; the chip makes the register's bytes itself, the same as ``Shield.latched`` has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.backends.avr.line import BoardLine
from trochia.backends.avr.windings import MASK, bits
from trochia.kernels.link import AT_REST, PART, SET_OUTPUTS, SPAN, fit_one
from trochia.kernels.ticks import BACKWARDS
from trochia.stepper.shield import Shield, Style

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.backends.avr.transports import Transport
    from trochia.stepper.times import Time

BOARD = "uno-l293d"
CLOCK = 16_000_000
REST = 0.25  #: a rest as long as this is one of the chip's as well [s]
MOST = 20_000  #: steps that are held
LEAD = 4000  #: ticks before the first step
TOLERANCE = 160.0  #: of a step: 10 µs [ticks]
SOON = 64  #: ticks in which a winding is released
SLEW = 0xFFFF  #: such a motor stops within a step
_NUMBERS = {style: number for number, style in enumerate(Style)}


class _Event(NamedTuple):
    """A step of a motor, or with direction 0 its release."""

    moment: float
    motor: int
    direction: int
    style: Style | None


class BoardShield(Shield):
    """A shield whose motors are moved by a board.

    Raises
    ------
    LinkError
        When the board is not there, is another, or does not speak our protocol.
    """

    def __init__(self, time: Time, transport: Transport) -> None:
        super().__init__(time)
        self._line = BoardLine(transport, BOARD)
        self._held: list[_Event] = []
        self._styles: list[int | None] = [None, None]
        self._line.switch(mask=MASK, outputs=bits(self._styles))
        self._line.switch(enable=1)

    def stepped(self, port: int, moment: float, direction: int, style: Style) -> None:
        """Take a step of a motor."""
        self._add(_Event(moment, port - 1, direction, style))

    def released(self, port: int, moment: float) -> None:
        """Take a motor's release."""
        self._add(_Event(moment, port - 1, 0, None))

    def flush(self) -> None:
        """Have the board do what is held, and wait until it has."""
        held, self._held = self._held, []
        if held:
            self._line.run(self._spans(held))

    def close(self) -> None:
        """Have it do what is held, then switch off."""
        try:
            self.flush()
        finally:
            self._line.close()

    def _add(self, event: _Event) -> None:
        if self._held and (event.moment - self._held[-1].moment > REST or len(self._held) == MOST):
            self.flush()
        self._held.append(event)

    def _spans(self, held: list[_Event]) -> Iterator[bytes]:
        """Return spans of events, at their distances in time."""
        begin, at, number = held[0].moment, 0, 0
        ticks = np.array([round((event.moment - begin) * CLOCK) + LEAD for event in held], np.int64)
        first = 0
        while first < len(held):
            event, after = held[first], first + 1
            while event.direction and after < len(held) and held[after][1:] == event[1:]:
                after += 1
            self._styles[event.motor] = None if event.style is None else _NUMBERS[event.style]
            head = np.zeros((), SPAN)
            head["number"], head["slew"], head["outputs"] = number & 0xFFFF, SLEW, bits(self._styles)
            if event.direction:
                part, made = fit_one(ticks[first:after] - at, TOLERANCE)
                part["flags"] |= BACKWARDS if event.direction < 0 else 0
                part["count"] = len(made) - 1
                head["motors"], after = 1 << event.motor, first + len(made)
                head["duration"], payload = int(made[-1]) + 1, part.astype(PART).tobytes()
            else:
                head["duration"], payload = max(int(ticks[first]) - at, 0) + SOON, b""
            head["flags"] = SET_OUTPUTS | (AT_REST if after == len(held) else 0)
            at, number, first = at + int(head["duration"]), number + 1, after
            if first < len(held):
                ticks[first:] = np.maximum(ticks[first:], at + SOON)
            yield head.tobytes() + payload
