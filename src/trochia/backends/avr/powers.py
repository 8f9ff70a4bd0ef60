"""The beam's power within a span, as the chip is sent it: pixels, each so many slots after the one before.

In: ticks at which the power changes.  Out: records of ``trochia_pixel``.  A slot is 8 µs, so a change is at most 4 µs
from its tick, and that does not add up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.link import PIXEL, PIXELS, SLOT

if TYPE_CHECKING:
    from numpy.typing import NDArray

FARTHEST = 255  #: slots from a pixel to the next
MOST = 255 // PIXELS  #: in a span


class Powers:
    """Powers of one span.

    Parameters
    ----------
    start
        Of the span [ticks].
    first
        Its power from there on, 0 … 255.
    room
        For pixels.
    """

    def __init__(self, start: int, first: int, room: int) -> None:
        self.first = first
        self._start, self._room = start, min(room, MOST)
        self._now = first
        self._slot = 0
        self._pixels: list[tuple[int, int, int]] = []  # slot, slots since the one before, power

    def add(self, at: int, power: int) -> bool:
        """Note a power from a tick on, not before those that were noted; return whether there was room."""
        if power == self._now:
            return True
        slot = (at - self._start + SLOT // 2) // SLOT
        more: list[tuple[int, int, int]] = []
        while slot - self._slot > FARTHEST:
            self._slot += FARTHEST
            more.append((self._slot, FARTHEST, self._now))
        more.append((slot, slot - self._slot, power))
        if len(self._pixels) + len(more) > self._room:
            return False
        self._pixels += more
        self._slot, self._now = slot, power
        return True

    def until(self, end: int) -> NDArray[np.void]:
        """Return the pixels before a tick (pixels,); behind it comes another span, which begins with its own power."""
        last = (end - self._start - 1) // SLOT
        return np.array([(after, power) for slot, after, power in self._pixels if slot <= last], PIXEL)
