"""A terminal for the sketches, in place of the board's serial monitor and reset button.

``--pace`` seconds of the motor a second (0: as fast as the computer can), ``--seconds`` until the power goes,
``--exact`` delays in place of the shield library's whole milliseconds, ``--board`` port of a real shield, whose board
has the image uno-l293d.  ``q`` or the end of the input switches off.
"""

from __future__ import annotations

import argparse
import os
import select
import sys
import termios
import tty
from collections import deque
from typing import TYPE_CHECKING

from trochia.backends.avr.transports import SerialTransport
from trochia.errors import TrochiaError
from trochia.stepper import PacedTime, Shield
from trochia.stepper.board import BoardShield

if TYPE_CHECKING:
    from collections.abc import Callable


class SwitchedOffError(Exception):
    """The power is gone."""


class Terminal(PacedTime):
    """Time, keys and lines of a sketch."""

    def __init__(self, purpose: str) -> None:
        parser = argparse.ArgumentParser(description=purpose, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--pace", type=float, default=1.0, help="seconds of the motor a second; 0: no waiting")
        parser.add_argument("--seconds", type=float, default=float("inf"), help="until the power goes")
        parser.add_argument("--exact", action="store_true", help="exact delays, not whole milliseconds")
        parser.add_argument("--rpm", type=int, default=50, help="first speed of a search")
        parser.add_argument("--board", metavar="PORT", help="make the steps on a board, too")
        self.options = parser.parse_args()
        super().__init__(self.options.pace)
        self.shield = BoardShield(self, SerialTransport(self.options.board)) if self.options.board else Shield(self)
        self._keys: deque[int] = deque()

    def wait_until(self, moment: float) -> None:
        """Let time pass, unless the power goes before."""
        super().wait_until(moment)
        self._listen(0.0)
        if self.now > self.options.seconds:
            raise SwitchedOffError

    def say(self, *words: object) -> None:
        """Print a line at once."""
        print(*words, flush=True)

    def key(self, *, wait: bool = False) -> int | None:
        """Return the next byte typed, or None; with ``wait``, wait for it: no time passes for the motor."""
        self._listen(None if wait and not self._keys else 0.0)
        return self._keys.popleft() if self._keys else None

    def line(self) -> str:
        """Wait for a line."""
        typed = bytearray()
        while (byte := self.key(wait=True)) not in (10, 13):
            typed.append(byte or 0)
        return typed.decode(errors="replace")

    def _listen(self, patience: float | None) -> None:
        """Take in what was typed."""
        if select.select([sys.stdin], [], [], patience)[0]:
            read = os.read(sys.stdin.fileno(), 256)
            if not read or b"q" in read or b"\x04" in read:
                raise SwitchedOffError
            self._keys.extend(read)


def run(sketch: Callable[[Terminal], None], purpose: str | None) -> None:
    """Run a sketch until it ends or is switched off; the terminal is left as it was."""
    terminal = Terminal(purpose or "")
    before = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    try:
        if before is not None:
            tty.setcbreak(sys.stdin.fileno())
        sketch(terminal)
    except (SwitchedOffError, KeyboardInterrupt):
        terminal.say(f"Switched off after {terminal.now:.3f} s.")
    except TrochiaError as error:
        terminal.say(error)
        sys.exit(1)
    finally:
        if isinstance(terminal.shield, BoardShield):
            terminal.shield.close()
        if before is not None:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
