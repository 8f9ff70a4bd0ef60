"""Where the application meets the network.  In: a desk, a bound socket.  Out: a server, to run here or in a thread."""

from __future__ import annotations

import socket
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING

import uvicorn

from trochia.errors import ConfigError
from trochia.server.app import make_app
from trochia.server.sockets import MOST_BYTES

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.server.desk import Desk

PING = 5.0  #: between pings of a socket, and how long their answer may take [s]


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens; port 0 takes any that is free.

    Raises
    ------
    ConfigError
        When the address is taken, or not one of this computer's.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family, backlog=64)
    except OSError as error:
        raise ConfigError(f"cannot listen at {host}, port {port}: {error.strerror}",
                          hint="Stop whoever uses the port, or choose another with --tcp.") from error  # fmt: skip


@dataclass(slots=True)
class Served:
    """A desk on the network.

    Parameters
    ----------
    tls
        Files of certificate and key; None: no encryption.
    """

    desk: Desk
    socket: socket.socket
    tls: tuple[Path, Path] | None = None
    _server: uvicorn.Server | None = None
    _thread: threading.Thread | None = None

    @property
    def port(self) -> int:
        """The port."""
        return int(self.socket.getsockname()[1])

    def run(self) -> None:
        """Serve until SIGINT or SIGTERM, or :meth:`close`."""
        self._made().run(sockets=[self.socket])

    def start(self) -> None:
        """Serve in a thread of its own, from before this returns."""
        server = self._made()
        self._thread = threading.Thread(target=self.run, name="trochia-server", daemon=True)
        self._thread.start()
        while not server.started and self._thread.is_alive():
            self._thread.join(0.01)

    def close(self) -> None:
        """Stop serving."""
        if self._server is not None:
            self._server.should_exit = True
        if self._thread is not None:
            self._thread.join()
        self.socket.close()

    def _made(self) -> uvicorn.Server:
        if self._server is None:
            certificate, key = self.tls or (None, None)
            self._server = uvicorn.Server(uvicorn.Config(
                make_app(self.desk), log_level="error", access_log=False, server_header=False, ws="websockets-sansio",
                ws_max_size=MOST_BYTES, ws_per_message_deflate=False, ws_ping_interval=PING, ws_ping_timeout=PING,
                timeout_graceful_shutdown=1, proxy_headers=False, http="h11", loop="asyncio",
                ssl_certfile=certificate, ssl_keyfile=key,
            ))  # fmt: skip
        return self._server
