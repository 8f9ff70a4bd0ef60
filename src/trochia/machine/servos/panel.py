"""An AC servo amplifier's front panel and enable chain: what must be pressed before a motor may be jogged by hand.

In: keys, faults, the control supply, time.  Out: the display, whether the motor has current, and which way it jogs.

    off --supply, 5 s--> PSoF --MODE/ESC--> Fn01 --ENT held 1 s--> JOG --ENT--> _JOG --up, down--> PJOG, nJOG
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

BOOT = 5.0  #: from power to the first display [s]
HOLD = 1.0  #: that ENT must be held to enter a function [s]


class Key(Enum):
    """The four keys."""

    MODE = "MODE/ESC"
    ENTER = "ENT"
    UP = "up"
    DOWN = "down"


@dataclass(slots=True)
class FrontPanel:
    """The panel of one amplifier, off at time zero.

    Attributes
    ----------
    display
        What it shows.
    energised
        Whether the motor has current.
    jogging
        1 up, -1 down, 0 at rest.
    """

    display: str = ""
    energised: bool = False
    jogging: int = 0
    fault: str | None = None
    _booted: float | None = None
    _held: float | None = None

    def supply(self, now: float, *, on: bool) -> None:
        """Switch the supply (the 24 V that it watches): without it the motor stops and loses its drive."""
        self._booted = now + BOOT if on else None
        self.display, self.fault = "", None
        self._off()

    def trip(self, fault: str) -> None:
        """Take note of a fault: the drive is off until it is reset, and ready is withdrawn."""
        self.fault, self.display = fault, fault
        self._off()

    def reset(self) -> None:
        """Forget the fault; the panel begins again."""
        if self.fault is not None:
            self.fault, self.display = None, "PSoF"

    def ready(self, now: float) -> bool:
        """Whether the controller may enable it: it has booted and has no fault."""
        self._wake(now)
        return self._booted is not None and now >= self._booted and self.fault is None

    def press(self, key: Key, now: float) -> None:
        """Press a key; it stays down until :meth:`release`."""
        if not self.ready(now):
            return
        if key is Key.ENTER:
            if self.display == "JOG":
                self.display, self.energised = "_JOG", True
            else:
                self._held = now
        elif key is Key.MODE:
            self._escape()
        elif self.energised:
            self.jogging = 1 if key is Key.UP else -1
            self.display = "PJOG" if key is Key.UP else "nJOG"

    def release(self, key: Key, now: float) -> None:
        """Let a key go."""
        if not self.ready(now):
            return
        if key is Key.ENTER:
            held = 0.0 if self._held is None else now - self._held
            if self.display == "Fn01" and held >= HOLD - 1e-9:
                self.display = "JOG"
            self._held = None
        elif key is not Key.MODE and self.energised:
            self.jogging, self.display = 0, "_JOG"

    def _wake(self, now: float) -> None:
        if self._booted is not None and now >= self._booted and not self.display:
            self.display = "PSoF"

    def _escape(self) -> None:
        """One step back, or on to the functions from the status display."""
        if self.energised:
            self._off()
            self.display = "JOG"
        else:
            self.display = {"PSoF": "Fn01", "Fn01": "PSoF", "JOG": "Fn01"}.get(self.display, self.display)

    def _off(self) -> None:
        self.energised, self.jogging, self._held = False, 0, None
