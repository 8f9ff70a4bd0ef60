"""A simulated AVR chip: an image in, bytes and levels in; bytes, pin edges and cycle stamps out.

In: an image (ELF), a program built from ``firmware/sim``.  Out: events, each stamped with the processor's cycle.  The
caller owns the chip's clock: it stands between two calls of ``run_until``, so nothing depends on the computer's speed.
"""

from __future__ import annotations

import struct
import subprocess
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from trochia.errors import LinkError

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType

    from numpy.typing import NDArray

#: what happened: cycle, kind, unit (port letter, serial port, timer), line (pin, channel), value
EVENT = np.dtype(
    [("cycle", "<u8"), ("kind", "u1"), ("unit", "S1"), ("line", "u1"), ("reserved", "u1"), ("value", "<u4")]
)
PIN, BYTE, PWM, LOST = 1, 2, 3, 4  #: kinds of events: an output's level, a byte sent, a channel's duty, a byte lost
_STATUS = struct.Struct("<QQIIII")
_STATES = {1: "runs", 2: "sleeps", 3: "stopped", 4: "crashed"}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChipRun:
    """What the chip did in one stretch.

    Attributes
    ----------
    cycle
        Where its clock stands now.
    asleep
        Cycles it has slept since reset.
    state
        ``runs``, ``sleeps``, ``stopped`` (asleep with interrupts off) or ``crashed``.
    interrupts
        Interrupts taken since reset.
    unread
        Bytes still on their way to it.
    events
        What happened, in order (events,), of dtype ``EVENT``.
    """

    cycle: int
    asleep: int
    state: str
    interrupts: int
    unread: int
    events: NDArray[np.void]

    @property
    def sent(self) -> bytes:
        """The bytes it sent."""
        return self.events["value"][self.events["kind"] == BYTE].astype(np.uint8).tobytes()

    @property
    def lost(self) -> int:
        """How many received bytes it lost."""
        return int(np.count_nonzero(self.events["kind"] == LOST))

    def edges(self, pin: str, level: int | None = None) -> NDArray[np.uint64]:
        """Return the cycles at which an output like ``B5`` changed (edges,), or only those up to ``level``."""
        mine = (self.events["kind"] == PIN) & (self.events["unit"] == pin[0].encode())
        mine &= self.events["line"] == int(pin[1:])
        if level is not None:
            mine &= self.events["value"] == level
        return self.events["cycle"][mine]


class SimulatedChip:
    """A chip at reset with an image in its flash.

    Parameters
    ----------
    program
        The simulator, built by ``make -C firmware/sim``.
    image
        ELF file.
    mcu, frequency
        The chip's name in avr-gcc's spelling, and its clock [Hz].

    Raises
    ------
    LinkError
        When the program cannot be started or stops answering.
    """

    def __init__(self, program: Path, image: Path, *, mcu: str = "atmega328p", frequency: int = 16_000_000) -> None:
        self.frequency = frequency
        try:
            self._process = subprocess.Popen(  # noqa: S603 - a program of our own, arguments as a list
                [program, image, mcu, str(frequency)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, start_new_session=True,  # Ctrl-C is ours: the chip is to be halted first
            )  # fmt: skip
        except OSError as error:
            raise LinkError(f"the simulated chip {program} cannot be started: {error.strerror}") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the simulation."""
        if self._process.stdin is not None and not self._process.stdin.closed:
            self._process.stdin.close()
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._process.wait(timeout=10)

    def run_until(self, cycle: int) -> ChipRun:
        """Go on until the clock stands at ``cycle`` (the instruction under way is finished), and tell what happened."""
        answer = self._ask(b"R", struct.pack("<Q", cycle))
        at, asleep, state, interrupts, unread, _ = _STATUS.unpack_from(answer)
        return ChipRun(
            cycle=at,
            asleep=asleep,
            state=_STATES[state],
            interrupts=interrupts,
            unread=unread,
            events=np.frombuffer(answer, EVENT, offset=_STATUS.size),
        )

    def feed(self, data: bytes, *, not_before: int = 0) -> None:
        """Send bytes to serial port 0, back to back at its own rate, the first not before a cycle."""
        self._ask(b"B", struct.pack("<Q", not_before) + data)

    def set_pin(self, pin: str, level: int) -> None:
        """Put an input like ``C1`` to a level, 0 or 1."""
        self._ask(b"P", struct.pack("<cBB", pin[0].encode(), int(pin[1:]), level))

    def set_analogue(self, channel: int, millivolts: int) -> None:
        """Put an analogue input to a voltage [mV]."""
        self._ask(b"A", struct.pack("<BxH", channel, millivolts))

    def read_memory(self, address: int, count: int) -> bytes:
        """Return bytes of data memory: registers, ports, RAM."""
        return self._ask(b"M", struct.pack("<HH", address, count))

    def write_memory(self, address: int, data: bytes) -> None:
        """Set bytes of RAM."""
        self._ask(b"W", struct.pack("<H", address) + data)

    def interrupts(self) -> dict[int, tuple[int, float, int]]:
        """Return by vector how often it was taken and its mean and worst cycles, from entry to the end of its reti."""
        rows = np.frombuffer(self._ask(b"I", b""), "<u8").reshape(-1, 3)
        return {
            vector: (int(taken), float(cycles / taken), int(worst))
            for vector, (taken, cycles, worst) in enumerate(rows)
            if taken
        }

    def _ask(self, letter: bytes, request: bytes) -> bytes:
        """Return the answer to a request."""
        to, back = self._process.stdin, self._process.stdout
        assert to is not None
        assert back is not None
        try:
            to.write(letter + struct.pack("<I", len(request)) + request)
            to.flush()
            (size,) = struct.unpack("<I", back.read(4))
            answer = back.read(size)
        except (OSError, ValueError, struct.error) as error:
            raise LinkError("the simulated chip has stopped answering") from error
        return answer
