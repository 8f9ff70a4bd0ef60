"""A board on a pseudo-terminal: an image on the simulated chip, or a function that answers; its cable can be pulled."""

from __future__ import annotations

import os
import pty
import select
import termios
import threading
import time
import tty
from functools import partial
from typing import TYPE_CHECKING

from trochia.backends.simulated_chip import SimulatedChip

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PIECE = 0.002  # s of the chip's time at once
LEASH = 0.01  # s that it goes on without its host
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
        self._lock = threading.Lock()
        self._ends: tuple[int, int] | None = None  # ours and theirs
        self._over = threading.Event()
        self.replug()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def replug(self) -> None:
        ours, theirs = pty.openpty()
        tty.setraw(theirs)
        os.set_blocking(ours, False)
        self.link.unlink(missing_ok=True)
        self.link.symlink_to(os.ttyname(theirs))
        with self._lock:
            self._ends = (ours, theirs)

    def pull(self) -> None:
        """Pull the cable; the board goes on by itself."""
        with self._lock:
            ends, self._ends = self._ends, None
            self.link.unlink(missing_ok=True)
            for end in ends or ():
                os.close(end)

    def end(self) -> None:
        self._over.set()
        self._thread.join()
        self.pull()

    def _garbled(self, data: bytes, theirs: int) -> bytes:
        same = termios.tcgetattr(theirs)[4] == self._speed
        return data if same else bytes(byte << 1 & 255 ^ 0xA5 for byte in data)

    def _run(self) -> None:
        while not self._over.is_set():
            with self._lock:
                if self._ends is not None:
                    self._pass_on(*self._ends)
                    continue
            self._answer(b"")
            time.sleep(PIECE)

    def _pass_on(self, ours: int, theirs: int) -> None:
        came = b""
        if select.select([ours], [], [], PIECE)[0]:
            came = os.read(ours, 4096)
        answer = self._garbled(self._answer(self._garbled(came, theirs)), theirs)
        if answer:
            os.write(ours, answer)


class LiveChip:
    """A simulated chip that keeps to the clock on the wall as well as it can; it is reset when it is made.

    ``runs`` is what it did, in order, and ``at`` its time.  Where its host goes by :meth:`clock`, the chip waits for a
    host that this computer keeps from its work, as the host waits for the chip.
    """

    def __init__(self, program: Path, image: Path, mcu: str) -> None:
        self._make = partial(SimulatedChip, program, image, mcu=mcu)
        self.chip = self._make()
        self.at, self._since, self._reset_at = 0.0, time.monotonic(), 0.0
        self._reset = False
        self._looks, self._looked = 0, 0.0  # how often its host has looked at the clock, and when last
        self.runs: list[object] = []

    def reset(self) -> None:
        """Reset the chip before its next piece: what it was doing is gone, and it counts from 0 again."""
        self._reset = True

    def clock(self) -> float:
        """The time its host goes by [s]."""
        self._looks, self._looked = self._looks + 1, self.at
        return 100.0 + self.at

    def leave(self) -> None:
        """Go on without a host."""
        self._looks = 0

    def close(self) -> None:
        self.chip.close()

    def __call__(self, came: bytes) -> bytes:
        now = time.monotonic()
        step = min(now - self._since, 2 * PIECE)  # where the computer is too slow, the chip's time is
        if self._looks > 1:  # the first time it is to be connected yet
            step = min(step, max(self._looked + LEASH - self.at, 0.0))
        self.at, self._since = self.at + step, now
        if self._reset:
            self._reset, self._reset_at = False, self.at
            self.chip.close()
            self.chip = self._make()
        if came:
            self.chip.feed(came)
        run = self.chip.run_until(round((self.at - self._reset_at) * self.chip.frequency))
        self.runs.append(run.events)
        return run.sent
