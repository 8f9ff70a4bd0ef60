"""The motor shield on a board: a step program's steps are made by the chip, each at its time.

In: steps as the shield's motors make them.  Out: spans for the image ``uno-l293d``, sent while the program goes on; the
chip makes the register's bytes itself, the same as ``Shield.latched`` has.  It begins ``START`` after the program, so
that it never waits for a step, and plays in one piece what lies between two rests.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.avr.line import BoardLine
from trochia.backends.avr.windings import MASK, bits
from trochia.stepper.shield import Shield, Style
from trochia.stepper.spans import Event, Spans

if TYPE_CHECKING:
    from trochia.backends.avr.transports import Transport
    from trochia.stepper.times import Time

BOARD = "uno-l293d"
REST = 0.1  #: without a step: a rest of the chip's as well [s]
CHUNK = 0.1  #: motion that is held before it is sent [s]
START = 0.4  #: motion that is sent before the chip is let go [s]


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
        self._held: list[Event] = []
        self._spans: Spans | None = None  # of what is under way
        self._went = 0.0  # the program's time when the chip was let go
        self._line.switch(mask=MASK, outputs=bits([None, None]))
        self._line.switch(enable=1)
        time.follow(self._passed)

    def stepped(self, port: int, moment: float, position: int, direction: int, style: Style) -> None:
        """Take a step of a motor."""
        super().stepped(port, moment, position, direction, style)
        self._add(Event(moment, port - 1, direction, list(Style).index(style)))

    def released(self, port: int, moment: float) -> None:
        """Take a motor's release."""
        super().released(port, moment)
        self._add(Event(moment, port - 1, 0, None))

    def flush(self) -> None:
        """Have the board do what is held, and wait until it has; errors as of the class."""
        if self._spans is not None:
            self._send()
            self._line.send(self._spans.at_rest())
            self._spans = None
            self._line.finish()

    def halt(self) -> None:
        """Stop the motors at once and release them; what is held is forgotten."""
        self._held, self._spans = [], None
        self._line.halt()

    def close(self) -> None:
        """Have it do what is held, then switch off."""
        try:
            self.flush()
        finally:
            self._line.close()

    def _add(self, event: Event) -> None:
        if self._spans is None:
            self._spans, self._last = Spans(event.moment), event.moment
            self._line.begin()
        elif event.moment - self._last > REST:
            self.flush()
            self._add(event)
            return
        self._held.append(event)
        self._last = event.moment
        if self._last - self._held[0].moment > CHUNK:
            self._send()

    def _send(self) -> None:
        """Send what is held; let the chip go where it has enough."""
        spans, held = self._spans, self._held
        if spans is None:
            return
        self._held = []
        gone = self._line.going
        for payload in spans.made(held):
            self._line.send(payload)
        if self._last - spans.begin > START:
            self._line.go()
        if self._line.going and not gone:
            self._went = self.time.now

    def _passed(self, now: float) -> None:
        """Keep up with the program's time; a rest is the chip's as well."""
        if self._spans is None:
            return
        if now - self._last > REST:
            self.flush()
        elif self._line.going:
            self._line.keep_up(now - self._went)
