"""The connection to one board: greeted when it is opened, and again by itself whenever it was lost.

In: a transport, the time.  Out: what the board tells.  A port that fails is opened anew, a board that is silent is
greeted anew; meanwhile ``lost`` says what is wrong, and whoever orders is refused.

connected --- the port fails ---> closed --- it opens (every AGAIN) ---> greeting --- it answers ---> connected
connected --- silence ---> greeting --- no answer in CONNECT, or a stranger's ---> closed
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from trochia.backends.avr.session import WINDOW, Greeted, Session, Told
from trochia.backends.avr.transports import Transport, first_number, unanswered
from trochia.backends.avr.troubles import described
from trochia.errors import LinkError, LinkTimeout, RemoteProtocolError
from trochia.kernels.link import RUNNING

if TYPE_CHECKING:
    from trochia.backends.avr.wiring import Board

CONNECT = 3.0  #: a board may take that long to answer after its reset [s]
LATENCY = 0.02  #: of an order to a chip that waits for its host [s]
LATE = 0.01  #: that turns of a host, and a plug on its USB, may take besides [s]
AWAY = 0.1  #: a host that was away for longer cannot say that the board was silent [s]
AGAIN = 1.0  #: between openings of a port that failed [s]


class Connection:
    """One board on a transport.

    Parameters
    ----------
    board
        Which it has to be.

    Attributes
    ----------
    session
        The protocol's state.
    answer, status
        Records of what the board said last, to a hello and of itself; None before.
    asked
        When its status was asked for last [s].
    now
        Up to when bytes have passed [s].
    latency
        How long an order takes to act [s]: on a real line one window of bytes may be on its way before it.
    lost
        Why there is no connection; empty: there is one.
    """

    def __init__(self, transport: Transport, board: Board) -> None:
        self.transport = transport
        self.session = Session(transport.baud, seed=first_number(transport))
        self.latency = LATENCY if transport.stride else LATENCY + LATE + 10.0 * WINDOW / transport.baud
        self.answer: Any = None
        self.status: Any = None
        self.now = self.asked = 0.0
        self.lost = "it has not been opened"
        self._board = board
        self._estop = 0
        self._opened = False  # whether the board has been there once: then it is connected to again
        self._closed_at: float | None = None  # since when the port is closed
        self._greeted_at = 0.0

    def open(self, now: float, *, estop: int = 0) -> None:
        """Connect, and wait until the board has told its status; ``estop``: inputs that stop it at once when low.

        Raises
        ------
        LinkTimeout
            When nothing answers.
        VersionMismatch
            When the image belongs to another program.
        RemoteProtocolError
            When it is an image for another board.
        """
        self.now, self._estop = now, estop
        self._greet()
        while self.lost:
            self.exchange(self.now + 0.002)
            if not self.transport.stride:
                time.sleep(0.002)
            if self.now - now > CONNECT:
                raise unanswered(self.transport, self.session.strange)
        self._opened = True
        self.now = now
        self.transport.rebase(now)

    def ask(self) -> None:
        """Ask for a status, where somebody is there."""
        if not self.lost:
            self.asked = self.now
            self.session.ask()

    def exchange(self, now: float) -> list[Told]:
        """Let bytes pass until ``now`` [s], and return the statuses that have come.

        Raises
        ------
        LinkError
            Before the board has been there once; afterwards ``lost`` says it.
        """
        told: list[Told] = []
        try:
            if self._closed_at is not None and not self._open_again(now):
                self.now = now
                return told
            if now - self.now > AWAY:
                self.session.listen(now)
            came = self.transport.exchange(self.session.outgoing(self.now), now)
            self.now = now
            for event in self.session.receive(came, now):
                if isinstance(event, Greeted):
                    self._greeted(event.answer)
                elif isinstance(event, Told) and self.lost and event.status["state"] == RUNNING:
                    self.session.ask()  # a board that was not reset brakes first
                elif isinstance(event, Told):
                    told.append(event)
                    self.status, self.lost = event.status, ""
                else:
                    self._silent(f"nothing has been heard from the board for {event.silence:.1f} s")
            if self.lost and self._opened and now - self._greeted_at > CONNECT:
                raise LinkTimeout(f"no board with Trochia's image answers: {described(self.session.strange)}")
        except LinkError as error:
            if not self._opened:
                raise
            self.now = now
            self._fail(error.message)
            return []
        return told

    def close(self) -> None:
        """Halt the board, drives off, and let go of the transport."""
        if not self.lost:
            self.session.halt(drives_off=True)
            self.exchange(self.now + 0.005)
        self.transport.close()

    # -- inside

    def _greet(self) -> None:
        self._greeted_at = self.now
        self.session.greet(self.now, estop=self._estop)

    def _greeted(self, answer: Any) -> None:  # noqa: ANN401 - a numpy record has no type of its own
        """Note who answers, and ask how it is."""
        name = bytes(answer["board"]).rstrip(b"\0").decode("ascii", "replace")
        if name != self._board.name:
            raise RemoteProtocolError(f"the board is {name}, not {self._board.name}", hint=f"Say --board {name}.")
        self.answer, self.asked = answer, self.now
        self.session.ask()

    def _silent(self, why: str) -> None:
        """Greet a board that says nothing: it may have been reset."""
        self.lost = why
        self._greet()

    def _fail(self, why: str) -> None:
        """Close the port, to open it again in a while."""
        self.lost, self._closed_at = why, self.now
        self.transport.close()

    def _open_again(self, now: float) -> bool:
        """Return whether the port is open; it is tried every ``AGAIN``."""
        if self._closed_at is None or now - self._closed_at < AGAIN:
            return False
        self._closed_at = now  # the next try, if this one fails
        try:
            self.transport.reopen()
        except LinkError as error:
            self.lost = error.message
            return False
        self._closed_at = None
        self.now = now
        self._greet()
        return True
