"""A board on a pseudo-terminal: an image on the simulated chip, or a function that answers; its cable can be pulled."""

from __future__ import annotations

import os
import pty
import select
import termios
import threading
import time
import tty
from typing import TYPE_CHECKING

from trochia.backends.simulated_chip import SimulatedChip

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PIECE = 0.002  # s of the chip's time at once
SPEEDS = {9600: termios.B9600, 115_200: termios.B115200, 1_000_000: termios.B1000000}


class PseudoBoard:
    """Answers on a terminal under a name of its own, until it is pulled.

    Parameters
    ----------
    answer
        Bytes that came in, and the terminal's rate; bytes that go out.  Called every few milliseconds.
    baud
        Of the board: at another rate of the terminal bytes are garbled both ways.
    """

    def __init__(self, link: Path, answer: Callable[[bytes], bytes], *, baud: int) -> None:
        self.link, self._answer, self._speed = link, answer, SPEEDS[baud]
        self.replug()

    def replug(self) -> None:
        self._ours, self._theirs = pty.openpty()
        tty.setraw(self._theirs)
        self.link.unlink(missing_ok=True)
        self.link.symlink_to(os.ttyname(self._theirs))
        os.set_blocking(self._ours, False)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def pull(self) -> None:
        if self._over.is_set():
            return
        self._over.set()
        self._thread.join()
        self.link.unlink(missing_ok=True)
        os.close(self._theirs)
        os.close(self._ours)

    def _garbled(self, data: bytes) -> bytes:
        same = termios.tcgetattr(self._theirs)[4] == self._speed
        return data if same else bytes(byte << 1 & 255 ^ 0xA5 for byte in data)

    def _run(self) -> None:
        while not self._over.is_set():
            came = b""
            if select.select([self._ours], [], [], PIECE)[0]:
                came = os.read(self._ours, 4096)
            answer = self._garbled(self._answer(self._garbled(came)))
            if answer:
                os.write(self._ours, answer)


class LiveChip:
    """A simulated chip that keeps to the clock on the wall as well as it can; it is reset when it is made.

    ``runs`` is what it did, in order, and ``at`` its time.
    """

    def __init__(self, program: Path, image: Path, mcu: str) -> None:
        self.chip = SimulatedChip(program, image, mcu=mcu)
        self.at, self._since = 0.0, time.monotonic()
        self.runs: list[object] = []

    def __call__(self, came: bytes) -> bytes:
        now = time.monotonic()
        step = min(now - self._since, 2 * PIECE)  # where the computer is too slow, the chip's time is
        self.at, self._since = self.at + step, now
        if came:
            self.chip.feed(came)
        run = self.chip.run_until(round(self.at * self.chip.frequency))
        self.runs.append(run.events)
        return run.sent
