"""What an encoder's edges are like: data of the equations of ``core/host/encoder.h``.

In: numbers.  Out: :class:`Edges`, and what closed forms say of them:

    speed by counts a period T     sigma = q / T √(1/6 + 2 s²)         q a count, s jitter in counts
    speed by time, of one count    sigma = v √(2 s² + (v c / f)² / 6)    v speed, c counts a unit, f the clock
    missed edges                   n passed, each missed with p: n p off on average, √(n p (1 - p)) about it
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from trochia.errors import ConfigError

MOST_JITTER = 0.2  #: beyond it edges would change places [counts]


@dataclass(frozen=True, slots=True, kw_only=True)
class Edges:
    """Edges looked at one by one.

    Attributes
    ----------
    jitter
        Standard deviation of an edge's place [counts].
    missed
        Part of the edges that are not counted.
    clock
        That times the edges for the speed [Hz]; None: speed is counts a period.
    turn
        Edges between index pulses; None: there are none.
    single
        Whether there is one channel only, which tells no direction.
    seed
        Of what is drawn.
    """

    jitter: float = 0.0
    missed: float = 0.0
    clock: float | None = None
    turn: int | None = None
    single: bool = False
    seed: int = 1

    def __post_init__(self) -> None:
        if not 0.0 <= self.jitter <= MOST_JITTER:
            raise ConfigError(f"must be 0 to {MOST_JITTER:g} counts, not {self.jitter!r}", key="jitter")
        if not 0.0 <= self.missed < 1.0:
            raise ConfigError(f"must be at least 0 and below 1, not {self.missed!r}", key="missed")
        if self.clock is not None and not 0.0 < self.clock < math.inf:
            raise ConfigError(f"must be above zero, not {self.clock!r} Hz", key="clock")
        if self.seed < 0:
            raise ConfigError(f"must not be below zero, not {self.seed}", key="seed")

    def counted_noise(self, counts: float, period: float) -> float:
        """Return the standard deviation of speed by counts a period [s], for counts a unit [units/s]."""
        return math.sqrt(1.0 / 6.0 + 2.0 * self.jitter**2) / (counts * period)

    def timed_noise(self, speed: float, counts: float) -> float:
        """Return the standard deviation of speed by the time of one count [units/s]; needs a clock."""
        ticks = 0.0 if self.clock is None else speed * counts / self.clock
        return speed * math.sqrt(2.0 * self.jitter**2 + ticks**2 / 6.0)
