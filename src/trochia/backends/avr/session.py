"""The host's end of the link, without any I/O: bytes in, events out; orders in, bytes out.

Orders are numbered, sent in order, kept until the chip says it took them, and sent again where it did not.  Times are
seconds of whatever clock the caller has; nothing here reads one.

state      event                        becomes
---------  ---------------------------  ---------------------------------------------
closed     ``greet``                    greeting
greeting   an answer, schema the same   open
greeting   an answer, another schema    refused: VersionMismatch
greeting   nothing for PATIENCE         lost: LinkTimeout
open       nothing for PATIENCE         lost (an event; the chip has braked by itself)
lost       any whole frame              open
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np

from trochia.errors import LocalProtocolError, VersionMismatch
from trochia.kernels.link import ACK, ANSWER, HELLO, LOOSE, SCHEMA, SCHEMA_BYTES, STATUS, TYPES, FrameReader, frame

PATIENCE = 0.5  #: of the host [s]
KEPT = 200  #: bytes of what is not understood
WINDOW = 120  #: bytes on their way, at most: the chip's receiver holds 127
_NAMES = {value: name for name, value in TYPES.items() if name != "loose"}
_SPAN = TYPES["span"]


@dataclass(slots=True)
class _Order:
    """An order on its way; ``token`` counts orders from the session's beginning, ``sent`` is when [s]."""

    token: int
    line: bytes
    room: int
    sent: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Greeted:
    """The chip answered a hello."""

    answer: Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """A status has come: a record of ``trochia_status``, when it was received [s], and how many orders it had seen."""

    status: Any
    time: float
    taken: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Lost:
    """Nothing has been heard for a while."""

    silence: float


Event = Greeted | Told | Lost


class Session:
    """One connection to one chip.

    Parameters
    ----------
    baud
        Of the line; it decides how long an answer may take.
    seed
        Of the number by which the chip knows one session from the next.

    Attributes
    ----------
    state
        As in the table above.
    broken
        Frames from the chip that were broken.
    repeated
        Orders that had to be sent again.
    strange
        The first bytes that came before the chip answered.
    """

    def __init__(self, baud: int = 115_200, *, seed: int = 0) -> None:
        self._session = seed & 255
        self.state = "closed"
        self.broken = self.repeated = 0
        self.strange = b""
        self._retry = 0.02 + 4000.0 / baud
        self._reader = FrameReader()
        self._orders: deque[_Order] = deque()
        self._loose: deque[bytes] = deque()
        self._next = self._taken = 0
        self._room = 0
        self._heard = self._greeted = self._rewound = 0.0
        self._hello = b""

    @property
    def room(self) -> int:
        """Free bytes of the chip's queue, less what is on its way to it."""
        return self._room - sum(order.room for order in self._orders)

    @property
    def taken(self) -> int:
        """How many orders the chip has taken."""
        return self._taken

    @property
    def waiting(self) -> int:
        """Orders that it has not taken yet."""
        return len(self._orders)

    def greet(self, now: float, *, silence: int = 250, estop: int = 0) -> None:
        """Say hello: everything that was on its way is forgotten."""
        order = np.zeros((), HELLO)
        order["schema"], order["silence"], order["estop"] = SCHEMA, silence, estop
        order["session"] = self._session = self._session % 255 + 1
        self._hello = frame(0, TYPES["hello"], order.tobytes())
        self._orders.clear()
        self._loose.clear()
        self._next = self._taken = 0
        self.state, self._heard, self._greeted, self.strange = "greeting", now, now, b""
        self._loose.append(b"\0" + self._hello)

    def order(self, kind: str, payload: bytes = b"") -> int:
        """Queue an order, and return its token: ``taken`` above it says that the chip has taken it.

        Raises
        ------
        LocalProtocolError
            Where there is no session, or no such order.
        """
        code = TYPES[kind]
        if code >= LOOSE:
            raise LocalProtocolError(f"{kind} is no order")
        if self.state not in {"open", "lost"}:
            raise LocalProtocolError(f"{kind} while the link is {self.state}")
        room = len(payload) if code == _SPAN else 0
        self._orders.append(_Order(self._next, frame(self._next & 255, code, payload), room))
        self._next += 1
        return self._next - 1

    def listen(self, now: float) -> None:
        """Take silence for silence from now on [s]: before, nobody here was listening."""
        self._heard = max(self._heard, now)

    def ask(self) -> None:
        """Ask for a status."""
        self._loose.append(frame(0, TYPES["ask"], b""))

    def halt(self, *, drives_off: bool) -> None:
        """Stop at once; it overtakes orders."""
        self._loose.append(frame(0, TYPES["halt"], bytes([drives_off])))

    def forget(self) -> None:
        """Drop orders that were never sent: what the chip might have of the others it will refuse by their number."""
        while self._orders and self._orders[-1].sent is None:
            self._orders.pop()
            self._next -= 1

    def outgoing(self, now: float) -> bytes:
        """Return the bytes to send now."""
        if self.state == "greeting" and now - self._greeted > self._retry:
            self._greeted = now
            self._loose.append(b"\0" + self._hello)
        parts = list(self._loose)
        self._loose.clear()
        if self.state not in {"open", "lost"}:
            return b"".join(parts)
        first = self._orders[0] if self._orders else None
        if first is not None and first.sent is not None and now - first.sent > self._retry:
            self._rewind(now)
        flying = 0
        for order in self._orders:
            flying += len(order.line)
            if flying > WINDOW and order is not first:  # one alone may be longer: a span of six motors
                break
            if order.sent is None:
                order.sent = now
                parts.append(order.line)
        return b"".join(parts)

    def _rewind(self, now: float) -> None:
        """Send again whatever the chip has not taken."""
        self._rewound = now
        for order in self._orders:
            self.repeated += order.sent is not None
            order.sent = None

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Take bytes that have come by now, and return what they mean.

        Raises
        ------
        VersionMismatch
            When the chip was compiled with another schema.
        """
        events: list[Event] = []
        if self.state == "greeting":
            self.strange = (self.strange + data)[:KEPT]
        for got in self._reader.feed(data):
            if got.kind < 0:
                self.broken += 1
                continue
            event = self._take(_NAMES.get(got.kind, ""), got.payload, now)
            if event is not None:
                events.append(event)
        if self.state == "open" and now - self._heard > PATIENCE:
            self.state = "lost"
            events.append(Lost(silence=now - self._heard))
        return events

    def _take(self, kind: str, payload: bytes, now: float) -> Event | None:
        if kind == "answer" and len(payload) >= SCHEMA_BYTES:
            return self._answered(payload, now)
        if self.state not in {"open", "lost"}:
            return None
        if kind in {"ack", "room"} and len(payload) == ACK.itemsize:
            ack = np.frombuffer(payload, ACK)[0]
            self._heard, self.state = now, "open"
            self._acknowledge(int(ack["expected"]), int(ack["room"]), now, repeat=kind == "ack")
        if kind == "status" and len(payload) == STATUS.itemsize:
            status = np.frombuffer(payload, STATUS)[0]
            self._heard, self.state = now, "open"
            self._acknowledge(int(status["expected"]), int(status["room"]), now, repeat=False)
            return Told(status=status, time=now, taken=self._taken)
        return None

    def _answered(self, payload: bytes, now: float) -> Event | None:
        if self.state != "greeting":
            return None
        schema = int.from_bytes(payload[:SCHEMA_BYTES], "little")
        if schema != SCHEMA:
            self.state = "refused"
            raise VersionMismatch(
                f"the board speaks schema {schema:08x}, this program {SCHEMA:08x}",
                hint="Write the image that belongs to this program with `trochia flash`.",
            )
        answer = np.frombuffer(payload, ANSWER)[0] if len(payload) == ANSWER.itemsize else None
        if answer is None or int(answer["session"]) != self._session:
            return None  # to a hello before this one, by this host or another
        self._next = self._taken = int(answer["expected"])  # 0, unless another host had the session's number
        self._room = int(answer["room"])
        self._heard, self.state = now, "open"
        return Greeted(answer=answer)

    def _acknowledge(self, expected: int, room: int, now: float, *, repeat: bool) -> None:
        """Forget orders the chip has taken; where it waits for one that was sent, send from there again."""
        done = (expected - self._taken) & 255
        if done > len(self._orders):
            return  # from before the last hello
        for _ in range(done):
            self._orders.popleft()
        self._taken += done
        self._room = room
        stuck = self._orders and self._orders[0].sent is not None
        if repeat and not done and stuck and now - self._rewound > 0.5 * self._retry:
            self._rewind(now)
