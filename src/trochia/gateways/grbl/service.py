"""The gateway at work: a door, a session, a controller.  ``turn`` does all there is to do; ``run`` calls it by a clock.

A sender that is gone while the machine moves leaves it held, not running on.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from trochia.gateways.grbl.session import Session

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable

    from trochia.controller.runtime import Runtime
    from trochia.gateways.grbl.doors import Door

PERIOD = 0.002  #: between turns [s]


class Service:
    """One door to one machine.

    Parameters
    ----------
    arm
        Whether senders may light the beam.
    """

    def __init__(self, runtime: Runtime, door: Door, *, arm: bool = False) -> None:
        self._runtime, self._door, self._arm = runtime, door, arm
        self.session: Session | None = None

    def turn(self, now: float) -> None:
        """Do what there is to do at ``now`` [s]."""
        data = self._door.read()
        if data is None:
            if self.session is not None:
                self.session.receive(b"!", now)  # nobody is there to stop it
                self.session.turn(now)
                self.session = None
            return
        if self.session is None:
            self.session = Session(self._runtime, arm=self._arm)
        self.session.receive(data, now)
        out = self.session.turn(now)
        if out:
            self._door.write(out)

    def run(self, over: threading.Event, clock: Callable[[], float] = time.monotonic) -> None:
        """Turn until it is over."""
        while not over.is_set():
            self.turn(clock())
            over.wait(PERIOD)
