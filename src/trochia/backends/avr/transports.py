"""How bytes get to a chip and back: a serial port, or the simulated chip.

A transport is told the time and given bytes; it gives back the bytes that have come by then.
"""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, Protocol

import serial

from trochia.backends.avr.images import BAUDS
from trochia.backends.avr.ports import Found, greeted, opened
from trochia.backends.avr.troubles import described
from trochia.backends.simulated_chip import SimulatedChip
from trochia.errors import LinkError, LinkTimeout

if TYPE_CHECKING:
    from pathlib import Path


PULLED = ("returned no data", "Input/output error", "No such device", "Write timeout")  #: what its port says then


class Transport(Protocol):
    """Bytes to and from one chip.

    Attributes
    ----------
    baud
        Of the line.
    stride
        How far :meth:`exchange` goes at once, at most [s]; 0 where time passes by itself.
    place
        Where the chip is, for a person.
    """

    baud: int
    stride: float
    place: str

    def exchange(self, data: bytes, now: float) -> bytes:
        """Send bytes, let time go on to ``now``, and return the bytes that have come.

        Raises
        ------
        LinkError
            When the other side is gone.
        """
        ...

    def rebase(self, now: float) -> None:
        """Call the present time ``now``."""
        ...

    def set_input(self, pin: str, level: int) -> None:
        """Put an input to a level, where somebody can."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...

    def reopen(self) -> None:
        """Take it again after it failed, and was let go of.

        Raises
        ------
        LinkError
            While it is not there.
        """
        ...


def unanswered(transport: Transport, heard: bytes) -> LinkTimeout:
    """Return what is wrong where our hello has no answer; on a port other baud rates are tried."""
    found = transport.elsewhere() if isinstance(transport, SerialTransport) else None
    if found is not None:
        return LinkTimeout(f"nothing answers at {transport.baud} baud; there is {found.text}",
                           hint=f"Say --baud {found.baud}.")  # fmt: skip
    return LinkTimeout(
        f"no board with Trochia's image answers: {described(heard)}",
        hint="Is it the right port and baud rate?  `trochia boards` looks; `trochia flash` writes.",
    )


def first_number(transport: Transport) -> int:
    """Return a number for a session that the host before hardly had: a board that is not reset remembers that."""
    return 0 if transport.stride else time.monotonic_ns() >> 10


class ChipTransport:
    """An image on the simulated chip; its clock is the caller's."""

    stride = 0.0005
    place = "on a simulated chip"

    def __init__(self, program: Path, image: Path, *, baud: int = 1_000_000, mcu: str = "atmega328p") -> None:
        self.baud = baud
        self.chip = SimulatedChip(program, image, mcu=mcu)
        self.edges: list[object] | None = None
        self._base: float | None = None
        self._at = 0.0

    def exchange(self, data: bytes, now: float) -> bytes:
        """See :class:`Transport`."""
        if self._base is None:
            self._base = now - 0.01  # the chip was reset a moment ago
        if data:
            self.chip.feed(data)
        self._at = now
        run = self.chip.run_until(round((now - self._base) * self.chip.frequency))
        if run.state not in {"runs", "sleeps"}:
            raise LinkError(f"the simulated chip has {run.state}")
        if self.edges is not None:
            self.edges.append(run.events)
        return run.sent

    def rebase(self, now: float) -> None:
        """See :class:`Transport`."""
        self._base = (self._base or 0.0) + now - self._at

    def set_input(self, pin: str, level: int) -> None:
        """Put an input like ``C1`` to a level."""
        self.chip.set_pin(pin, level)

    def close(self) -> None:
        """End the simulation."""
        self.chip.close()

    def reopen(self) -> None:
        """Refuse: a simulated chip has no cable to put back."""
        raise LinkError("the simulated chip has ended", hint="Begin again.")


class SerialTransport:
    """A board on a serial port; time passes by itself.

    Raises
    ------
    LinkError
        When the port cannot be opened, or another program has it.
    """

    stride = 0.0

    def __init__(self, port: str, *, baud: int = 115_200) -> None:
        self.baud = baud
        self.name = port
        self.place = f"on {port}"
        self._port = opened(port, baud)

    def exchange(self, data: bytes, now: float) -> bytes:  # noqa: ARG002 - time passes by itself
        """See :class:`Transport`."""
        try:
            if data:
                self._port.write(data)
            return bytes(self._port.read(4096))
        except (serial.SerialException, OSError) as error:
            pulled = any(words in str(error) for words in PULLED)
            why = "nobody is at the other end any more" if pulled else str(error)
            raise LinkError(f"the board on {self.name} is gone: {why}", hint="Is the cable in?") from None

    def elsewhere(self) -> Found | None:
        """Return what answers at another baud rate."""
        try:
            tried = (greeted(self._port, self.name, baud, bytearray()) for baud in BAUDS if baud != self.baud)
            return next((found for found in tried if found is not None), None)
        except (serial.SerialException, OSError):
            return None

    def rebase(self, now: float) -> None:
        """See :class:`Transport`; time is what it is."""

    def set_input(self, pin: str, level: int) -> None:  # noqa: ARG002 - real inputs are not ours to set
        """Refuse: real inputs are not ours to set."""
        raise LinkError(f"nobody sets the input {pin} of a real board")

    def close(self) -> None:
        """Close the port."""
        with suppress(OSError):  # of a device that is gone
            self._port.close()

    def reopen(self) -> None:
        """Open the port again; see :class:`Transport`."""
        self._port = opened(self.name, self.baud)
