"""What is wrong at the other end of the line, for a person.

In: causes as the chip tells them, bytes of a stranger.  Out: causes as the controller knows them, a sentence.
"""

from __future__ import annotations

import re

from trochia.backends.live import Trouble
from trochia.messages import Cause

#: of a stop, as the chip names it -> of an alarm
TROUBLES = {
    "low": Trouble(cause=Cause.UNDERRUN),
    "missed": Trouble(cause=Cause.UNDERRUN, text="the board could not make a step in time, and stopped at once"),
    "late_cut": Trouble(cause=Cause.UNDERRUN, text="an order came too late to the board, which braked along the path"),
    "bad_span": Trouble(cause=Cause.UNDERRUN, text="motion came to the board out of order, and it braked"),
    "silence": Trouble(cause=Cause.LINK, text="the board heard nothing from here, and braked along the path"),
    "estop": Trouble(cause=Cause.ESTOP, text="emergency stop, by the board's own input"),
}  # fmt: skip
GRBL = re.compile(rb"Grbl ?[\w.]*|<(?:Idle|Run|Hold|Jog|Alarm|Door|Check|Home|Sleep)[|:][^>\r\n]*>")


def described(heard: bytes) -> str:
    """Return what the bytes of somebody look like who does not speak our protocol."""
    if not heard:
        return "nothing answers"
    if GRBL.search(heard):
        return "a GRBL board is there (`trochia run --backend grbl`)"
    plain = sum(32 <= byte < 127 or byte in b"\r\n\t" for byte in heard)
    if plain >= 0.9 * len(heard):
        first = heard.decode("ascii", "replace").strip().splitlines()
        return f"it speaks, but neither our protocol nor GRBL's: {(first or [''])[0][:60]!r}"
    return f"{len(heard)} bytes came that make no sense: another baud rate, or another firmware"
