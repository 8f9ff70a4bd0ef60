"""A terminal for the sketches, in place of the board's serial monitor and reset button.

The motors are twins: the source's motor behind the shield's bridges, 12 V.  ``--backend simavr`` has the steps made by
the shield's image on a simulated chip as well, ``--backend avr --port DEVICE`` by a real board with a real shield.
``q``, Ctrl-C or the end of the input stops the motors, releases them and ends.
"""

from __future__ import annotations

import argparse
import os
import select
import signal
import sys
import termios
import tty
from collections import deque
from pathlib import Path
from typing import TYPE_CHECKING

from trochia.backends.avr.simulator import simulated
from trochia.backends.avr.transports import SerialTransport
from trochia.errors import TrochiaError
from trochia.stepper import PacedTime, Shield, ShieldMotor, ShieldTwin
from trochia.stepper.board import BOARD, BoardShield
from trochia.stepper.picture import picture

if TYPE_CHECKING:
    from collections.abc import Callable

ERASE = {8, 127}  # the keys that take a character back
SETTLING = 0.1  # s that a rotor has after its last step
DISPLAYED = 0.2  # s between two looks at the motors


class SwitchedOffError(Exception):
    """The power is gone."""


class Terminal(PacedTime):
    """Time, keys and lines of a sketch."""

    def __init__(self, options: argparse.Namespace) -> None:
        super().__init__(options.pace)
        self.options = options
        self._keys: deque[int] = deque()
        self._live = sys.stdout.isatty() and options.pace > 0
        self._shown = 0.0
        self._interrupted = False
        self.shield = self._shield()

    def _shield(self) -> Shield:
        backend, port = self.options.backend, self.options.port
        if backend == "twin":
            return Shield(self)
        if backend == "simavr":
            print("Starting the simulated chip; its first time takes a while.", file=sys.stderr)
        return BoardShield(self, simulated(BOARD) if backend == "simavr" else SerialTransport(port))

    def motor(self, port: int, *, steps_per_turn: int = 200) -> ShieldMotor:
        """Return the shield's motor on a port, its twin beside it."""
        self.shield.twins[port] = ShieldTwin(keep=self.options.picture is not None)
        return self.shield.motor(port, steps_per_turn, whole_milliseconds=not self.options.exact)

    def wait_until(self, moment: float) -> None:
        """Let time pass, unless the power goes before."""
        super().wait_until(moment)
        self._listen(0.0)
        if self._live and self.now - self._shown > DISPLAYED * self.options.pace:
            self._shown = self.now
            looks = (f"motor {port}: {twin.look(self.now).turning}" for port, twin in self.shield.twins.items())
            sys.stdout.write(f"\r\x1b[K{self.now:8.1f} s  {'  '.join(looks)}")
            sys.stdout.flush()
        if self.now > self.options.seconds:
            raise SwitchedOffError

    def idle(self, asker: Callable[[], float | None]) -> None:
        """Let time pass to what is due next, or to the next key."""
        moment = self._next(asker)
        while moment is not None and self.now < moment and not self._keys:
            self.wait_until(min(moment, self.now + 0.02 * self.options.pace) if self.options.pace else moment)

    def say(self, *words: object) -> None:
        """Print a line at once."""
        print("\r\x1b[K" if self._live else "", *words, sep="", flush=True)

    def say_rotors(self) -> None:
        """Print where the rotors are."""
        for port, twin in self.shield.twins.items():
            self.say(f"Motor {port}: {twin.look(self.now + SETTLING)}.")

    def key(self, *, wait: bool = False) -> int | None:
        """Return the next byte typed, or None; with ``wait``, wait for it: no time passes for the motor."""
        if wait and not self._keys and isinstance(self.shield, BoardShield):
            self.shield.flush()
        self._listen(None if wait and not self._keys else 0.0)
        return self._keys.popleft() if self._keys else None

    def line(self) -> str:
        """Wait for a line, which is shown as it is typed; the erase key takes back a character."""
        typed: list[str] = []
        while (byte := self.key(wait=True)) not in (10, 13):
            if byte in ERASE:
                typed = typed[:-1]
            elif byte is not None and byte >= ord(" "):
                typed.append(chr(byte))
            if sys.stdout.isatty():
                sys.stdout.write(f"\r\x1b[K{''.join(typed)}")
                sys.stdout.flush()
        if sys.stdout.isatty():
            print()
        return "".join(typed)

    def _listen(self, patience: float | None) -> None:
        """Take in what was typed; Ctrl-C is heard here and nowhere else, never in the midst of a step."""
        while True:
            heard = select.select([sys.stdin], [], [], 0.1 if patience is None else patience)[0]
            read = os.read(sys.stdin.fileno(), 256) if heard else b"."
            if self._interrupted or not read or any(end in read for end in (b"q", b"\x03", b"\x04")):
                raise KeyboardInterrupt
            if heard:
                self._keys.extend(read)
            if heard or patience is not None:
                return

    def interrupt(self, *_: object) -> None:
        """Take notice of Ctrl-C."""
        if self._interrupted:  # twice: at once
            raise KeyboardInterrupt
        self._interrupted = True

    def stop(self, *, at_once: bool) -> None:
        """Stop the motors and release them; without ``at_once`` after what is under way."""
        if isinstance(self.shield, BoardShield):
            if at_once:
                self.shield.halt()
            self.shield.close()
        for twin in self.shield.twins.values():
            twin.release(self.now)


def run(sketch: Callable[[Terminal], None], purpose: str | None) -> None:
    """Run a sketch until it ends or is switched off; the terminal is left as it was."""
    options = _options(purpose or "")
    before = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    try:
        terminal = Terminal(options)
        if before is not None:
            tty.setcbreak(sys.stdin.fileno())
        _run(sketch, terminal)
        if options.picture is not None:
            terminal.say(f"Drawn to {picture(options.picture, *terminal.shield.twins.values())}.")
    except TrochiaError as error:
        print(f"\r\x1b[K{error}" if sys.stdout.isatty() else error, file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:  # before there was anything to stop
        sys.exit(130)
    finally:
        if before is not None:
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


def _run(sketch: Callable[[Terminal], None], terminal: Terminal) -> None:
    """Run a sketch, and stop its motors in any case."""
    at_once = True
    signal.signal(signal.SIGINT, terminal.interrupt)
    try:
        sketch(terminal)
        at_once = False
    except SwitchedOffError:
        at_once = False
        terminal.say(f"Switched off after {terminal.now:.3f} s.")
    except KeyboardInterrupt:
        terminal.say(f"Stopped and released after {terminal.now:.3f} s.")
    finally:
        terminal.say_rotors()
        terminal.stop(at_once=at_once)


def _options(purpose: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=purpose, epilog="q or Ctrl-C stops the motor and ends.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add(
        "--backend",
        choices=("twin", "simavr", "avr"),
        default="twin",
        help="who makes the steps: the twin alone; the shield's image on a simulated chip; a real board and shield",
    )
    add("--port", metavar="DEVICE", help="serial port of the board, for --backend avr")
    add("--pace", type=float, default=1.0, help="seconds of the motor a second; 0: no waiting, the default is 1")
    add("--seconds", type=float, default=float("inf"), help="until the power goes")
    add("--exact", action="store_true", help="exact delays, not whole milliseconds as the shield's library has")
    add("--rpm", type=int, default=50, help="first speed of a search, the default is 50")
    add("--picture", type=Path, metavar="FILE.png", help="draw what the motor did")
    options = parser.parse_args()
    if not 0 <= options.pace < float("inf"):
        parser.error(f"--pace must be 0 or more, not {options.pace:g}")
    if not options.seconds > 0:
        parser.error(f"--seconds must be more than 0, not {options.seconds:g}")
    if not 0 < options.rpm <= 1000:
        parser.error(f"--rpm must be from 1 to 1000, not {options.rpm}")
    if (options.backend == "avr") != (options.port is not None):
        parser.error("--backend avr and --port DEVICE go together")
    if options.backend != "twin" and 0 < options.pace < 1:
        parser.error("a chip keeps to real time: --pace 1 or more, or 0")
    return options
