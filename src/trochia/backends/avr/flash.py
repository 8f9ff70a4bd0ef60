"""Writing an image to a board, by avrdude over the board's own bootloader.

In: a board, an image, a port.  Out: avrdude's command line; what it says when it fails, as one clear error.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from typing import TYPE_CHECKING

from trochia.errors import ConfigError, LinkError

if TYPE_CHECKING:
    from trochia.backends.avr.images import Image
    from trochia.backends.avr.wiring import Board

PATIENCE = 180.0  #: with avrdude: a large image at 57,600 baud takes a minute [s]
BOOTLOADER = 115_200  #: its baud rate; that of old bootloaders is 57,600
#: signature -> chip, of those that are likely on such a board
CHIPS = {"1e950f": "an ATmega328P (Uno)", "1e9514": "an ATmega328", "1e9516": "an ATmega328PB",
         "1e9801": "an ATmega2560 (Mega)", "1e9587": "an ATmega32U4 (Leonardo)", "1e9406": "an ATmega168P"}  # fmt: skip
_SIGNATURE = re.compile(r"signature\s*=\s*((?:0x)?[0-9a-fA-F]{2}[ ]?[0-9a-fA-F]{2}[ ]?[0-9a-fA-F]{2})")
#: words of avrdude in lower case -> what they mean and what to do, the first that fits
_TROUBLES = (
    (("permission denied",), "you may not use {port}", "Join the group that may: `sudo adduser $USER dialout`."),
    (("resource busy", "resource temporarily"), "another program has {port} open", "Close it first."),
    (("cannot open port", "no such file", "can't open device"), "there is no port {port}",
     "Is the cable in?  `trochia boards` lists the ports."),
    (("mismatch", "verification error"), "what was read back from {port} is not what was written", "Write it again."),
    (("not in sync", "not responding", "timeout", "unable to open programmer", "bad response", "out of sync"),
     "nothing on {port} answers as the bootloader of {board} does; nothing was written",
     "Is it the right port and board?  One with an old bootloader needs --bootloader 57600."),
)  # fmt: skip


def command(board: Board, image: Image, port: str, *, bootloader: int = BOOTLOADER) -> list[str]:
    """Return the command line that writes an image."""
    return ["avrdude", "-p", board.mcu, "-c", board.programmer, "-P", port, "-b", str(bootloader), "-D",
            "-U", f"flash:w:{image.path}:i"]  # fmt: skip


def write(board: Board, image: Image, port: str, *, bootloader: int = BOOTLOADER) -> None:
    """Write an image to the board on a port, and have it read back.

    Raises
    ------
    ConfigError
        When avrdude is not installed.
    LinkError
        When it fails.
    """
    line = command(board, image, port, bootloader=bootloader)
    program = shutil.which(line[0])
    if program is None:
        raise ConfigError("avrdude, which writes images to boards, is not installed",
                          hint="Install it: `sudo apt-get install avrdude`.")  # fmt: skip
    try:
        done = subprocess.run(  # noqa: S603 - a list
            [program, *line[1:]],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        raise LinkError(
            f"avrdude has not ended after {PATIENCE:.0f} s on {port}", hint="Pull the cable, try again."
        ) from None
    if done.returncode:
        raise trouble(done.stderr + done.stdout, board, port)


def trouble(said: str, board: Board, port: str) -> LinkError:
    """Return what avrdude's words mean."""
    low = said.lower()
    signature = _SIGNATURE.search(said)
    if "expected signature" in low and signature is not None:
        found = signature[1].lower().removeprefix("0x").replace(" ", "")
        return LinkError(
            f"the chip on {port} is {CHIPS.get(found, f'one with signature {found}')}, "
            f"not the {board.mcu} of {board.name}; nothing was written",
            hint="Name the board that is there; `trochia boards` lists the ports.",
        )
    for words, meaning, remedy in _TROUBLES:
        if any(word in low for word in words):
            return LinkError(meaning.format(port=port, board=board.name), hint=remedy)
    first = next((line.strip() for line in said.splitlines() if "error" in line.lower()), said.strip()[:200])
    return LinkError(f"avrdude failed on {port}: {first}")
