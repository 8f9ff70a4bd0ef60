"""Guessing passwords is slow.  In: attempts that failed, by address.  Out: how long the next one has to wait."""

from __future__ import annotations

from collections import OrderedDict

FREE = 3  #: failures that cost nothing: people mistype
FIRST = 1.0  #: wait after the next [s]; it doubles with each
LONGEST = 30.0  #: wait [s]
FORGIVEN = 600.0  #: failures are forgotten after so long without one [s]
MOST = 1024  #: addresses remembered


class Throttle:
    """Counts failures by address."""

    def __init__(self) -> None:
        self._failed: OrderedDict[str, tuple[int, float]] = OrderedDict()

    def wait(self, address: str, now: float) -> float:
        """Return how long this address has to wait yet before it may try [s]; 0.0: not at all."""
        count, when = self._failed.get(address, (0, now))
        if count <= FREE or now - when > FORGIVEN:
            return 0.0
        return max(when + min(FIRST * 2.0 ** (count - FREE - 1), LONGEST) - now, 0.0)

    def failed(self, address: str, now: float) -> None:
        """Note a failure."""
        count, when = self._failed.pop(address, (0, now))
        self._failed[address] = (1 if now - when > FORGIVEN else count + 1, now)
        if len(self._failed) > MOST:
            self._failed.popitem(last=False)

    def succeeded(self, address: str) -> None:
        """Forget the failures of an address."""
        self._failed.pop(address, None)
