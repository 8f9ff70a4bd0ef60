"""What is wrong at the other end of the line, for a person.

In: causes as the chip tells them, bytes of a stranger.  Out: causes as the controller knows them, a sentence.
"""

from __future__ import annotations

import re

from trochia.messages import Cause

#: of a stop, as the chip names it -> of an alarm
TROUBLES = {
    "missed": Cause.UNDERRUN, "late_cut": Cause.UNDERRUN, "bad_span": Cause.UNDERRUN, "silence": Cause.LINK,
    "estop": Cause.ESTOP,
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
