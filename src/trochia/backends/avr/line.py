"""A board that is given spans directly, without a plan or a controller: for step programs.

In: spans with what they put the outputs to, all at once or while the first of them run.  Out: when they have been run
through.
"""

from __future__ import annotations

import time
from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.avr.session import Greeted, Session, Told
from trochia.backends.avr.transports import Transport, first_number, unanswered
from trochia.errors import LinkError, RemoteProtocolError
from trochia.kernels.link import BEGIN, CAUSES, PUT, STATES

if TYPE_CHECKING:
    from collections.abc import Iterable


CONNECT = 4.0  #: a board may take that long to answer after its reset [s]
TURN = 0.001  #: between turns [s]
ASKED = 0.02  #: between questions how far it is [s]
AHEAD = 3  #: orders under way before another is handed over
POSTED = 500  #: spans that wait
KEPT_UP = 0.002  #: from one listening to the next, while a program goes on [s]
HALTING = 50  #: turns until a halt is through
PATIENCE = 2.0  #: with a board that does not answer them [s]


class BoardLine:
    """One board on a transport, greeted.

    Raises
    ------
    LinkTimeout
        When nothing answers.
    VersionMismatch
        When the image belongs to another program.
    RemoteProtocolError
        When it is another board.
    """

    def __init__(self, transport: Transport, board: str) -> None:
        self._transport = transport
        self._session = Session(transport.baud, seed=first_number(transport))
        self._answer: Any = None
        self._told: Told | None = None
        self._asked = self._heard = 0.0
        self._now = 0.0 if transport.stride else time.monotonic()
        self._posted: deque[bytes] = deque()  # spans that wait for room
        self._begun = -1  # the order that began what runs
        self._started: float | None = None  # when it was let go
        self._session.greet(self._now)
        end = self._now + CONNECT
        while self._answer is None:
            self._turn()
            self._heard = self._now
            if self._now > end:
                raise unanswered(transport, self._session.strange)
        name = bytes(self._answer["board"]).rstrip(b"\0").decode("ascii", "replace")
        if name != board:
            raise RemoteProtocolError(f"the board is {name}, not {board}")

    def switch(self, *, enable: int = 255, mask: int = 0, outputs: int = 0) -> None:
        """Put drives (0 off, 1 on, 255 as they are) and outputs at once."""
        order = np.zeros((), PUT)
        order["enable"], order["lit"], order["mask"], order["outputs"] = enable, 255, mask, outputs
        self._awake()
        token = self._session.order("switch", order.tobytes())
        while self._session.taken <= token:
            self._turn()

    def run(self, spans: Iterable[bytes]) -> None:
        """Run spans through, the last of which ends at rest, and wait until they are.

        Raises
        ------
        LinkError
            When the board stops before, with its reason, or does not answer.
        """
        self.begin()
        for payload in spans:
            self.send(payload)
        self.finish()

    def begin(self) -> None:
        """Take up a new stretch of spans."""
        self._awake()
        order = np.zeros((), BEGIN)
        order["epoch"] = 1
        self._begun = self._session.order("begin", order.tobytes())
        self._posted.clear()
        self._started = None

    def send(self, payload: bytes) -> None:
        """Take a span; it is handed over when the board has room.  Errors as of ``run``."""
        self._posted.append(payload)
        while len(self._posted) > POSTED:
            self.go()
            self._turn()
            self._look()

    def go(self) -> None:
        """Let it go, once it has what it can hold of what was sent; unless it goes already."""
        if self._started is None:
            while self._posted and self._session.room >= len(self._posted[0]):
                self._turn()
            self._session.order("go")
            self._started = self._now

    @property
    def going(self) -> bool:
        """Whether it was let go."""
        return self._started is not None

    def keep_up(self, since: float) -> None:
        """Listen and hand over; a simulated chip goes on to as long after ``go`` [s].  Errors as of ``run``."""
        if self._transport.stride or time.monotonic() > self._now + KEPT_UP:
            self._turn()
        while self._transport.stride and self._started is not None and self._now < self._started + since:
            self._turn()
        self._look()

    def finish(self) -> None:
        """Let it go, and wait until it has run through what it has.  Errors as of ``run``."""
        self.go()
        while self._posted:
            self._turn()
            self._look()
        last = self._session.taken + self._session.waiting
        while self._look() != "idle" or self._told is None or self._told.taken < last:
            self._turn()
        self._started = None

    def halt(self) -> None:
        """Stop it at once, whatever it holds, and switch its drives off."""
        self._awake()
        self._posted.clear()
        self._session.forget()
        self._session.halt(drives_off=True)
        self._started = None
        for _ in range(HALTING):
            self._turn()

    def close(self) -> None:
        """Drives off, and let go of the port."""
        try:
            self.switch(enable=0)
        finally:
            self._transport.close()

    def _awake(self) -> None:
        """Begin to listen again: nobody did while nothing was to be done."""
        if not self._transport.stride:
            self._now = time.monotonic()
        self._heard = self._now

    def _look(self) -> str:
        """Return the state it told last; refuse one that stopped before its end."""
        told = self._told
        if told is None or told.taken <= self._begun:
            return ""
        state = STATES.get(int(told.status["state"]), "")
        if state == "stopped":
            cause = CAUSES.get(int(told.status["cause"]), "?")
            hint = "Steps came too late: this computer has too much to do." if cause == "low" else None
            raise LinkError(f"the board stopped before the end: {cause.replace('_', ' ')}", hint=hint)
        return state

    def _turn(self) -> None:
        """Let a moment pass, hand over what there is room for, and ask how far it is now and then."""
        while self._posted and self._session.waiting <= AHEAD and self._session.room >= len(self._posted[0]):
            self._session.order("span", self._posted.popleft())
        if self._answer is not None and self._now - self._asked > ASKED:
            self._asked = self._now
            self._session.ask()
        now = self._now + self._transport.stride if self._transport.stride else time.monotonic()
        came = self._transport.exchange(self._session.outgoing(self._now), now)
        self._now = now
        for event in self._session.receive(came, now):
            if isinstance(event, Greeted):
                self._answer = event.answer
            elif isinstance(event, Told):
                self._told, self._heard = event, now
        if self._answer is not None and now - self._heard > PATIENCE:
            raise LinkError(f"the board has not been heard for {now - self._heard:.1f} s", hint="Is the cable in?")
        if not self._transport.stride:
            time.sleep(TURN)
