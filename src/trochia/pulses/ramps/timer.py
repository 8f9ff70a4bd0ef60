"""Whether a chip's timer can count the delays: the long first one must fit its register, the short ones be fine enough.

In: a profile, the chip's clock.  Out: for each division of the clock the ticks of the longest and the shortest delay
(S1-F37).  A timer that is too slow makes speeds coarse; one that is too fast cannot hold the first delay.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.pulses.ramps.profile import Profile

BITS = 16  #: of the register
DIVISIONS = (1, 8, 64, 256, 1024)  #: of an ATmega's 16-bit timer


@dataclass(frozen=True, slots=True, kw_only=True)
class TimerSetting:
    """A division of the chip's clock.

    Attributes
    ----------
    clock
        Of the timer [Hz].
    longest, shortest
        Delay [ticks].
    """

    division: int
    clock: float
    longest: int
    shortest: int

    @property
    def fits(self) -> bool:
        """Whether the register holds the longest delay, and the shortest is at least a tick."""
        return self.longest <= 2**BITS - 1 and self.shortest >= 1

    @property
    def slowest(self) -> float:
        """Lowest speed whose delay the register holds [steps/s]."""
        return self.clock / (2**BITS - 1)

    @property
    def coarseness(self) -> float:
        """Part of the greatest speed that one tick changes."""
        return 1.0 / max(self.shortest, 1)


def setting(made: Profile, clock: float, division: int = 1) -> TimerSetting:
    """Return what a timer of a clock [Hz], divided, makes of a profile."""
    ticks = clock / division * made.delays
    return TimerSetting(division=division, clock=clock / division, longest=round(float(ticks.max())),
                        shortest=round(float(ticks.min())))  # fmt: skip


def settings(made: Profile, clock: float) -> tuple[TimerSetting, ...]:
    """Return every division of a chip's clock [Hz]."""
    return tuple(setting(made, clock, division) for division in DIVISIONS)


def best(made: Profile, clock: float) -> TimerSetting | None:
    """Return the finest division that holds every delay; None: none does."""
    return next((one for one in settings(made, clock) if one.fits), None)
