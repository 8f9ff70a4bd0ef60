"""A board that is given spans directly, without a plan or a controller: for step programs.

In: spans with what they put the outputs to.  Out: when they have been run through.
"""

from __future__ import annotations

import time
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
        token = self._session.order("switch", order.tobytes())
        self._heard = self._now
        while self._session.taken <= token:
            self._turn()

    def run(self, spans: Iterable[bytes]) -> None:
        """Run spans through, the last of which ends at rest, and wait until they are.

        Raises
        ------
        LinkError
            When the board stops before, with its reason, or does not answer.
        """
        order = np.zeros((), BEGIN)
        order["epoch"] = 1
        begun = self._session.order("begin", order.tobytes())
        self._heard = self._now
        going = False
        for payload in spans:
            while self._session.room < len(payload) or self._session.waiting > 3:
                if self._session.room < len(payload) and not going and not self._session.waiting:
                    going = True
                    self._session.order("go")
                self._turn()
                self._look(begun)
            self._session.order("span", payload)
        if not going:
            self._session.order("go")
        last = self._session.taken + self._session.waiting
        while self._look(begun) != "idle" or self._told is None or self._told.taken < last:
            self._turn()

    def close(self) -> None:
        """Drives off, and let go of the port."""
        try:
            self.switch(enable=0)
        finally:
            self._transport.close()

    def _look(self, begun: int) -> str:
        """Return the state it told last; refuse one that stopped before its end."""
        told = self._told
        if told is None or told.taken <= begun:
            return ""
        state = STATES.get(int(told.status["state"]), "")
        if state == "stopped":
            cause = CAUSES.get(int(told.status["cause"]), "?")
            raise LinkError(f"the board stopped before the end: {cause.replace('_', ' ')}")
        return state

    def _turn(self) -> None:
        """Let a moment pass, and ask how far it is now and then."""
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
