"""The chip's clock as the host sees it.

In: when a status was asked for and received [s], and the chip's time in it [ticks].  Out: the host's time of a chip's
time.  The answer with the shortest way there and back is the one to believe; older ones are forgotten, because crystals
drift apart.
"""

from __future__ import annotations

from collections import deque

KEPT = 32  #: samples


class ChipClock:
    """Time of a chip that counts ``frequency`` ticks a second in 32 bits."""

    def __init__(self, frequency: int) -> None:
        self.frequency = frequency
        self._high = 0
        self._last: int | None = None
        self._samples: deque[tuple[float, float]] = deque(maxlen=KEPT)

    def unwrapped(self, ticks: int) -> int:
        """Return ticks since the first sample's turn, of 32 bits that come in order."""
        if self._last is not None and ticks < self._last:
            self._high += 1 << 32
        self._last = ticks
        return self._high + ticks

    def sample(self, asked: float, received: float, ticks: int) -> float:
        """Take a sample, and return the host's time of it [s]."""
        chip = self.unwrapped(ticks) / self.frequency
        self._samples.append((received - asked, 0.5 * (asked + received) - chip))
        return min(self._samples)[1] + chip
