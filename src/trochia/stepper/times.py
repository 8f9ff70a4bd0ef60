"""Time for motors that share it.

In: what waits for a moment.  Out: now.  Motors ask ``now`` and, when nothing is due, let time pass to the next thing
that is: in virtual time at once, so that a sketch is proved as fast as the computer can; in real time by waiting.
"""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Protocol

from trochia.errors import LimitError

if TYPE_CHECKING:
    from collections.abc import Callable

SLICE = 0.02  #: most that passes on the wall before who follows is told [s]
BEHIND = 0.1  #: most that is caught up with: who waited for a key is not hurried afterwards [s]


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

    def follow(self, told: Callable[[float], None]) -> None:
        """Add somebody who is told when time has passed, and what it is now [s]."""
        ...

    def idle(self, asker: Callable[[], float | None]) -> None:
        """Let time pass to whatever is due next, on behalf of one who has joined."""
        ...


class VirtualTime:
    """Time that stands still until somebody waits."""

    def __init__(self) -> None:
        self._now = 0.0
        self._dues: list[Callable[[], float | None]] = []
        self._told: list[Callable[[float], None]] = []
        self._asked: list[Callable[[], float | None]] = []  # who idled since time last went on

    @property
    def now(self) -> float:
        """Time since the beginning [s]."""
        return self._now

    def wait_until(self, moment: float) -> None:
        """Go to a moment [s], never back."""
        if moment > self._now:
            self._now = moment
            self._asked.clear()
            for told in self._told:
                told(moment)

    def join(self, due: Callable[[], float | None]) -> None:
        """Add somebody who can say when something is due next [s]; None: nothing is."""
        self._dues.append(due)

    def follow(self, told: Callable[[float], None]) -> None:
        """Add somebody who is told when time has passed, and what it is now [s]."""
        self._told.append(told)

    def idle(self, asker: Callable[[], float | None]) -> None:
        """Go to whatever is due next, on behalf of one who has joined.

        Where something is due already, its owner has the next word; but who asks a second time has found nobody who
        takes it: a motor that is no longer run holds up no other.
        """
        moment = self._next(asker)
        if moment is not None:
            self.wait_until(moment)

    def _next(self, asker: Callable[[], float | None]) -> float | None:
        """Return when time should stop next [s]; None: it may not go on."""
        moments = [moment for due in self._dues if (moment := due()) is not None]
        if min(moments, default=math.inf) <= self._now and asker not in self._asked:
            self._asked.append(asker)
            return None
        return min((moment for moment in moments if moment > self._now), default=None)

    def wait(self, duration: float) -> None:
        """Let a duration [s] pass."""
        self.wait_until(self.now + duration)


class PacedTime(VirtualTime):
    """Virtual time that does not run ahead of the clock on the wall.

    Parameters
    ----------
    pace
        Seconds of virtual time a second; 0: as fast as the computer can.

    Raises
    ------
    LimitError
        For a pace below 0, or that is no number.
    """

    def __init__(self, pace: float = 1.0) -> None:
        if not 0.0 <= pace < math.inf:
            raise LimitError(f"the pace must be 0 or more seconds a second, not {pace:g}",
                             hint="1 is real time, 0 as fast as the computer can.")  # fmt: skip
        super().__init__()
        self._pace = pace
        self._began = time.monotonic()  # when time was 0, had it never stood

    def wait_until(self, moment: float) -> None:
        """Wait until the wall clock has come to a moment [s]."""
        while self._pace and (left := self._left(moment)) > 1e-6:
            time.sleep(min(left, SLICE))
            super().wait_until(min(moment, (time.monotonic() - self._began) * self._pace))
        super().wait_until(moment)

    def _left(self, moment: float) -> float:
        """Return what is left to a moment on the wall [s]; time that was not waited for does not count."""
        wall = time.monotonic()
        self._began = max(self._began, wall - self._now / self._pace - BEHIND)
        return moment / self._pace - (wall - self._began)
