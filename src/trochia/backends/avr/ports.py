"""What is on the serial ports: a board with our image, one with GRBL, something else, nothing.

In: a port's name.  Out: what answered there.  It is asked so that nothing begins to move: whoever speaks GRBL is
asked for a status only, by one byte; our image by a hello of no schema, which it answers and otherwise ignores, and
which holds no byte that GRBL acts upon.  Opening a port resets most boards, and at reset ours stand still.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import serial
from serial.tools import list_ports

from trochia.backends.avr.images import BAUDS
from trochia.backends.avr.troubles import GRBL, described
from trochia.errors import LinkError
from trochia.kernels.link import ANSWER, HELLO, SCHEMA, SCHEMA_BYTES, TYPES, FrameReader, frame

if TYPE_CHECKING:
    from collections.abc import Callable

BOOTS = 2.1  #: a board's bootloader may take that long to let go after a reset [s]
ANSWERS = 0.8  #: how long a hello is repeated at each baud rate [s]
EVERY = 0.1  #: between questions [s]
_ACTS = frozenset((*b"~!?$\r\n\x18", *range(0x80, 0x100)))  # bytes that GRBL acts upon


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What a port has on it.

    Attributes
    ----------
    kind
        ``trochia``, ``grbl``, ``other`` (it speaks, but neither), ``silent`` or ``closed`` (it cannot be opened).
    text
        The same for a person.
    """

    port: str
    kind: str
    text: str
    board: str | None = None
    baud: int | None = None
    schema: int | None = None


def names() -> dict[str, str | None]:
    """Return the serial ports of this computer, and what their plug says it is."""
    return {
        port.device: None if port.description == "n/a" else port.description
        for port in sorted(list_ports.comports())
        if port.hwid != "n/a" or not port.device.startswith("/dev/ttyS")  # sockets that a PC may have, or not
    }


def opened(port: str, baud: int) -> serial.SerialBase:
    """Return a port that nobody else has open.

    Raises
    ------
    LinkError
        When it cannot be had, with the reason.
    """
    try:
        return serial.serial_for_url(port, baud, timeout=0, write_timeout=0.5, exclusive=True)
    except (serial.SerialException, OSError, ValueError) as error:
        raise LinkError(f"{port} {_reason(error)}", hint="`trochia boards` lists the ports.") from None


def _reason(error: Exception) -> str:
    text = str(error).lower()
    if "exclusively lock" in text or "busy" in text or "temporarily unavailable" in text:
        return "is in use by another program"
    if "permission" in text:
        return "may not be used by you (join the group dialout: `sudo adduser $USER dialout`)"
    return "is not there" if "no such" in text else f"cannot be opened: {error}"


def question() -> bytes:
    """Return a hello that is answered and changes nothing, without a byte that GRBL acts upon."""
    hello, asked = np.zeros((), HELLO), b""
    for number in range(256):  # only the checksum depends on it
        hello["session"] = number
        asked = b"\0" + frame(0, TYPES["hello"], hello.tobytes())
        if not _ACTS & set(asked):
            break
    return asked


def look(port: str, *, boots: float = BOOTS, clock: Callable[[], float] = time.monotonic) -> Found:
    """Ask what is on a port; takes a few seconds where nothing answers at once."""
    try:
        with opened(port, BAUDS[0]) as line:
            return _asked(line, port, boots, clock)
    except (LinkError, serial.SerialException, OSError) as error:
        text = error.message if isinstance(error, LinkError) else str(error)
        return Found(port=port, kind="closed", text=text.removeprefix(f"{port} "))


def _asked(line: serial.SerialBase, port: str, boots: float, clock: Callable[[], float]) -> Found:
    """First listen, and ask as GRBL is asked; then say hello, at every baud rate."""
    heard = bytearray()
    end = clock() + boots
    while clock() < end:
        line.write(b"?")
        heard += _listen(line, EVERY)
        if (spoken := GRBL.search(heard)) is not None:
            heard += _listen(line, EVERY)
            banner = re.search(rb"Grbl [^\r\n]*", heard)
            said = (banner or spoken)[0].decode("ascii", "replace")
            return Found(port=port, kind="grbl", text=f"a GRBL board: {said}", baud=line.baudrate)
    for baud in BAUDS:
        found = greeted(line, port, baud, heard, clock)
        if found is not None:
            return found
    return Found(port=port, kind="other" if heard else "silent", text=described(bytes(heard)))


def greeted(
    line: serial.SerialBase, port: str, baud: int, heard: bytearray, clock: Callable[[], float] = time.monotonic
) -> Found | None:
    """Say hello at a baud rate, and return who answers; what comes is added to what was heard."""
    line.baudrate = baud
    reader, end = FrameReader(), clock() + ANSWERS
    while clock() < end:
        line.write(question())
        came = _listen(line, EVERY)
        heard += came
        for got in reader.feed(came):
            if got.kind == TYPES["answer"] and len(got.payload) >= SCHEMA_BYTES:
                return _ours(port, baud, got.payload)
    return None


def _listen(line: serial.SerialBase, seconds: float) -> bytes:
    """Return what comes within a time."""
    time.sleep(seconds)
    return bytes(line.read(4096))


def _ours(port: str, baud: int, payload: bytes) -> Found:
    """Return what an answer says; one of another version may be shorter or longer."""
    answer = np.frombuffer(payload[: ANSWER.itemsize].ljust(ANSWER.itemsize, b"\0"), ANSWER)[0]
    board, schema = bytes(answer["board"]).rstrip(b"\0").decode("ascii", "replace"), int(answer["schema"])
    text = f"{board or 'our image'} at {baud} baud, schema {schema:08x}"
    if schema != SCHEMA:
        text += f"; this program speaks {SCHEMA:08x}: write its image with `trochia flash {board or 'BOARD'}`"
    return Found(port=port, kind="trochia", text=text, board=board, baud=baud, schema=schema)
