"""Time for motors that share it.

In: what waits for a moment.  Out: now.  Motors ask ``now`` and, when nothing is due, let time pass to the next thing
that is: in virtual time at once, so that a sketch is proved as fast as the computer can; in real time by waiting.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable


class Time(Protocol):
    """What a motor asks of time."""

    @property
    def now(self) -> float:
        """Time since the beginning [s]."""
        ...

    def wait_until(self, moment: float) -> None:
        """Let time pass to a moment [s]."""
        ...

    def join(self, due: Callable[[], float | None]) -> None:
        """Add somebody who can say when something is due next [s]; None: nothing is."""
        ...

    def idle(self) -> None:
        """Let time pass to whatever is due next."""
        ...


class VirtualTime:
    """Time that stands still until somebody waits."""

    def __init__(self) -> None:
        self._now = 0.0
        self._dues: list[Callable[[], float | None]] = []

    @property
    def now(self) -> float:
        """Time since the beginning [s]."""
        return self._now

    def wait_until(self, moment: float) -> None:
        """Go to a moment [s], never back."""
        self._now = max(self._now, moment)

    def join(self, due: Callable[[], float | None]) -> None:
        """Add somebody who can say when something is due next [s]; None: nothing is."""
        self._dues.append(due)

    def idle(self) -> None:
        """Go to whatever is due next; nowhere when something is due already, or nothing at all."""
        moments = [moment for due in self._dues if (moment := due()) is not None]
        if moments:
            self.wait_until(min(moments))

    def wait(self, duration: float) -> None:
        """Let a duration [s] pass."""
        self.wait_until(self.now + duration)


class PacedTime(VirtualTime):
    """Virtual time that does not run ahead of the clock on the wall.

    Parameters
    ----------
    pace
        Seconds of virtual time a second; 0: as fast as the computer can.
    """

    def __init__(self, pace: float = 1.0) -> None:
        super().__init__()
        self._pace = pace
        self._began = time.monotonic()

    def wait_until(self, moment: float) -> None:
        """Wait until the wall clock has come to a moment [s]."""
        if self._pace:
            left = moment / self._pace - (time.monotonic() - self._began)
            if left > 0.0:
                time.sleep(left)
        super().wait_until(moment)
