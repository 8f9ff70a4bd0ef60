"""The latest status, for everybody who looks.

In: statuses from the controller's thread.  Out: each as text once, for all; whoever is slow gets the newest one next,
never the ones between.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from trochia.messages import encode

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Callable

    from trochia.messages import Status

REMEMBERED = 64  #: statuses whose age is known: some 1.3 s


class Hub:
    """Brings statuses from one thread to the server's.

    Attributes
    ----------
    sequence
        Of the latest status.
    """

    def __init__(self, first: Status) -> None:
        self._latest = first
        self._text: str | None = None
        self._given = first  # by the other thread
        self._called = False  # whether the loop knows that something was given
        self._loop: asyncio.AbstractEventLoop | None = None
        self._waking: set[Callable[[], None]] = set()
        self._made: deque[tuple[int, float]] = deque(maxlen=REMEMBERED)
        self.sequence = first.sequence

    def begin(self, loop: asyncio.AbstractEventLoop) -> None:
        """Serve this loop from now on."""
        self._loop = loop

    def end(self) -> None:
        """Serve nobody any more."""
        self._loop = None

    # -- the controller's thread

    def give(self, status: Status) -> None:
        """Note the latest status, and let the server's thread know."""
        loop = self._loop
        self._given = status  # before the flag is looked at: the other thread looks at them in the other order
        if loop is not None and not self._called:
            self._called = True
            try:
                loop.call_soon_threadsafe(self._publish)
            except RuntimeError:  # the loop has just been closed
                self._loop = None

    # -- the server's thread

    @property
    def latest(self) -> Status:
        """The latest status."""
        return self._latest

    @property
    def text(self) -> str:
        """The message that tells the latest status; made once for all who send it."""
        if self._text is None:
            self._text = '{"status":' + encode(self._latest).decode() + "}"
        return self._text

    def join(self, wake: Callable[[], None]) -> None:
        """Call ``wake`` at every new status."""
        self._waking.add(wake)

    def leave(self, wake: Callable[[], None]) -> None:
        """Do so no more."""
        self._waking.discard(wake)

    def age(self, sequence: int) -> float:
        """Return how long ago the server got the status of this number [s]; infinite: too long, or never."""
        loop = self._loop
        for number, when in reversed(self._made):
            if number == sequence and loop is not None:
                return loop.time() - when
        return float("inf")

    def _publish(self) -> None:
        self._called = False
        status = self._given
        if status is self._latest or self._loop is None:
            return
        self._latest, self._text, self.sequence = status, None, status.sequence
        self._made.append((status.sequence, self._loop.time()))
        for wake in self._waking:
            wake()
