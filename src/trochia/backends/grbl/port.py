"""A serial port that never blocks.  In: a device's name.  Out: bytes, or a LinkError that says what to do."""

from __future__ import annotations

from typing import Protocol

import serial

from trochia.errors import LinkError

BAUD = 115_200


class Port(Protocol):
    """Somewhere bytes go to and come from; nothing waits."""

    def read(self) -> bytes:
        """Return what has come."""
        ...

    def write(self, data: bytes) -> None:
        """Send."""
        ...

    def close(self) -> None:
        """Let go of it."""
        ...


class SerialPort:
    """A serial device, or anything that looks like one to the system.

    Raises
    ------
    LinkError
        When it cannot be opened, and whenever the cable is out.
    """

    def __init__(self, name: str, baud: int = BAUD) -> None:
        self._name = name
        try:
            self._port = serial.Serial(name, baud, timeout=0, write_timeout=1.0, exclusive=True)
        except (serial.SerialException, OSError, ValueError) as error:
            raise LinkError(f"{name} cannot be opened: {error}",
                            hint="Look at the name, that nobody else has it open, and that you may use it.",
                            ) from None  # fmt: skip

    def read(self) -> bytes:
        """Return what has come."""
        try:
            return self._port.read(4096)
        except (serial.SerialException, OSError, TypeError) as error:  # TypeError: closed by another thread
            raise LinkError(f"{self._name} is gone: {error}") from None

    def write(self, data: bytes) -> None:
        """Send."""
        try:
            self._port.write(data)
        except (serial.SerialException, OSError, TypeError) as error:
            raise LinkError(f"{self._name} is gone: {error}") from None

    def close(self) -> None:
        """Let go of it."""
        self._port.close()
