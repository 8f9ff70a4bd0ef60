"""The blocking face of a machine at a distance: the asyncio one, in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING, Any, Self, TypeVar

from trochia.client.asynchronous import PATIENCE, AsyncClient
from trochia.errors import LinkError

if TYPE_CHECKING:
    from collections import deque
    from collections.abc import Callable, Coroutine

    from trochia.messages import Ack, AnyCommand, Frame, SessionStatus, Status

_T = TypeVar("_T")


class Client:
    """One session at a machine; made by :meth:`connect`.  It does what :class:`AsyncClient` does, and blocks."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="trochia-client", daemon=True)
        self._thread.start()
        self._client: AsyncClient | None = None

    @classmethod
    def connect(cls, url: str, user: str, password: str) -> Self:
        """Log in and connect; see :meth:`AsyncClient.connect`."""
        made = cls()
        try:
            made._client = made._do(AsyncClient.connect(url, user, password))
        except BaseException:
            made.close()
            raise
        return made

    def close(self) -> None:
        """Disconnect."""
        if self._client is not None:
            self._do(self._client.close())
            self._client = None
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Disconnect."""
        self.close()

    @property
    def inner(self) -> AsyncClient:
        """The asyncio client; its calls belong to another thread."""
        if self._client is None:
            raise LinkError("this client has been closed")
        return self._client

    @property
    def status(self) -> Status:
        """The newest status."""
        status = self.inner.status
        if status is None:
            raise LinkError("no status has come yet")
        return status

    @property
    def session(self) -> SessionStatus | None:
        """Who one is."""
        return self.inner.session

    @property
    def frames(self) -> deque[Frame]:
        """Frames of samples that nobody has taken."""
        return self.inner.frames

    def command(self, command: AnyCommand, *, timeout: float = PATIENCE) -> Ack:
        """Have a command taken; see :meth:`AsyncClient.command`."""
        return self._do(self.inner.command(command, timeout=timeout))

    def take(self, *, over: bool = False) -> None:
        """Take control; see :meth:`AsyncClient.take`."""
        self._do(self.inner.take(over=over))

    def release(self) -> None:
        """Give control back."""
        self._do(self.inner.release())

    def stop(self) -> None:
        """Stop everything now."""
        self._do(self.inner.stop())

    def watch(self, *, samples: bool) -> None:
        """Have samples sent, or no more."""
        self._do(self.inner.watch(samples=samples))

    def path(self, points: int = 200_000) -> Frame:
        """Return the path of the loaded program; see :meth:`AsyncClient.path`."""
        return self._do(self.inner.path(points))

    def jog(self, axis: str, speed: float, seconds: float) -> None:
        """Move an axis for a while; see :meth:`AsyncClient.jog`."""
        self._do(self.inner.jog(axis, speed, seconds))

    def wait_until(self, wanted: str | Callable[[Status], bool], *, timeout: float | None = None) -> Status:
        """Return the first status that is wanted; see :meth:`AsyncClient.wait_until`."""
        return self._do(self.inner.wait_until(wanted, timeout=timeout))

    def run(self, name: str, text: str, *, timeout: float | None = None) -> Status:
        """Run a program to its end; see :meth:`AsyncClient.run`."""
        return self._do(self.inner.run(name, text, timeout=timeout))

    def _do(self, work: Coroutine[Any, Any, _T]) -> _T:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()
