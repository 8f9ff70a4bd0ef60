"""Where senders come in: a TCP port, or a pseudo-terminal that looks like a serial port.  Neither ever blocks.

In: nothing.  Out: connections to one sender at a time; a second one is told so and sent away.
"""

from __future__ import annotations

import os
import socket
import tty
from pathlib import Path
from typing import Protocol

from trochia.errors import ConfigError

_BUSY = b"[MSG:another sender is connected]\r\n"


class Door(Protocol):
    """A way in for one sender at a time.

    Attributes
    ----------
    name
        What to tell a sender to connect to.
    """

    name: str

    def read(self) -> bytes | None:
        """Return what a sender has said; None: nobody is connected."""
        ...

    def write(self, data: bytes) -> None:
        """Tell the sender."""
        ...

    def close(self) -> None:
        """Let nobody in any more."""
        ...


class TcpDoor:
    """A TCP port; port 0 takes any that is free.

    Raises
    ------
    ConfigError
        When the address cannot be had.
    """

    def __init__(self, host: str = "127.0.0.1", port: int = 0) -> None:
        try:
            self._listener = socket.create_server((host, port))
        except OSError as error:
            raise ConfigError(f"cannot listen on {host}:{port}: {error.strerror}",
                              hint="Choose another port, or end the program that has it.") from None  # fmt: skip
        self._listener.setblocking(False)  # noqa: FBT003 - the system's own
        self._sender: socket.socket | None = None
        address = self._listener.getsockname()
        self.name = f"{address[0]}:{address[1]}"

    def read(self) -> bytes | None:
        """Return what the sender has said; let one in where there is none."""
        data = self._heard()
        if self._sender is not None and data is None:
            self._leave()  # before another is let in: that it is gone must be seen
            return None
        self._let_in()
        return b"" if data is None and self._sender is not None else data

    def write(self, data: bytes) -> None:
        """Tell the sender; one that does not listen is let go."""
        if self._sender is None:
            return
        try:
            self._sender.sendall(data)
        except OSError:
            self._leave()

    def close(self) -> None:
        """Close the port."""
        self._leave()
        self._listener.close()

    def _heard(self) -> bytes | None:
        """Return what the sender has said; None where there is none, or no more."""
        if self._sender is None:
            return None
        try:
            return self._sender.recv(4096) or None
        except BlockingIOError:
            return b""
        except OSError:
            return None

    def _let_in(self) -> None:
        try:
            sender, _ = self._listener.accept()
        except OSError:
            return
        if self._sender is not None:
            with sender:
                sender.sendall(_BUSY)
            return
        sender.setblocking(False)  # noqa: FBT003 - the system's own
        sender.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._sender = sender

    def _leave(self) -> None:
        if self._sender is not None:
            self._sender.close()
            self._sender = None


class TerminalDoor:
    """A pseudo-terminal; a sender opens it like any serial port.

    Parameters
    ----------
    link
        Where a symbolic link to it is put; None: only its own name.
    """

    def __init__(self, link: Path | None = None) -> None:
        self._ours, self._theirs = os.openpty()  # theirs stays open: a sender may come and go
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.name = os.ttyname(self._theirs)
        self._link = link
        if link is not None:
            try:
                link.symlink_to(self.name)
            except OSError as error:
                raise ConfigError(f"{link} cannot be made: {error.strerror}", hint="Choose another name.") from None
            self.name = str(link)

    def read(self) -> bytes | None:
        """Return what has been said; who is there, a terminal does not tell."""
        try:
            return os.read(self._ours, 4096)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        """Say something; what nobody fetches is dropped once the terminal is full."""
        try:
            while data:
                data = data[os.write(self._ours, data) :]
        except BlockingIOError:
            pass

    def close(self) -> None:
        """Remove it."""
        os.close(self._ours)
        os.close(self._theirs)
        if self._link is not None:
            Path(self._link).unlink(missing_ok=True)
