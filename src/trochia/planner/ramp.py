"""From one speed and acceleration to another in the least time.  In: both, limits.  Out: pieces of constant jerk.

Legend: v, a speed along the path and its derivative; A, J greatest |a| and |da/dt|; J infinite lets a jump.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Piece(NamedTuple):
    """Constant jerk ``j`` for ``duration``, from v and a."""

    duration: float
    v: float
    a: float
    j: float

    @property
    def way(self) -> float:
        """How far it goes."""
        t = self.duration
        return t * (self.v + t * (self.a / 2 + t * self.j / 6))

    @property
    def end(self) -> tuple[float, float]:
        """Return speed and acceleration at its end."""
        t = self.duration
        return self.v + t * (self.a + t * self.j / 2), self.a + t * self.j


def ramp(here: tuple[float, float], there: tuple[float, float], most_a: float, most_j: float) -> list[Piece]:
    """Return the quickest pieces from (v, a) to (v, a): jerk ±J, constant a, jerk ∓J, those of no duration left out.

    Where a is beyond A at the start it is brought back at once, unless the goal would be missed by that: then a goes
    as far as it takes.  Speed may fall below zero on the way: callers look.
    """
    (v0, a0), (v1, a1) = here, there
    if math.isinf(most_j):
        rise = math.copysign(most_a, v1 - v0)
        return _pieces(v0, rise, ((v1 - v0) / rise, 0.0))
    direct = v0 + (a1 * abs(a1 - a0) + a0 * abs(a1 - a0)) / (2 * most_j)  # by one change of a
    up = 1.0 if v1 >= direct else -1.0
    square = up * most_j * (v1 - v0) + (a0 * a0 + a1 * a1) / 2
    peak = up * math.sqrt(max(square, 0.0))
    even = 0.0
    if abs(peak) > most_a:
        most = up * most_a
        even = (v1 - v0 - (_changed(a0, most, most_j) + _changed(most, a1, most_j))) / most
        peak, even = (most, even) if even >= 0.0 else (peak, 0.0)
    return _pieces(v0, a0, _jerk(a0, peak, most_j), (even, 0.0), _jerk(peak, a1, most_j))


def _jerk(a0: float, a1: float, most_j: float) -> tuple[float, float]:
    """Return for how long which jerk leads from one acceleration to another."""
    return abs(a1 - a0) / most_j, math.copysign(most_j, a1 - a0)


def _changed(a0: float, a1: float, most_j: float) -> float:
    """Return by how much v changes meanwhile."""
    return abs(a1 - a0) / most_j * (a0 + a1) / 2


def _pieces(v: float, a: float, *parts: tuple[float, float]) -> list[Piece]:
    made: list[Piece] = []
    for duration, j in parts:
        if duration > 0.0:
            made.append(Piece(duration, v, a, j))
            v, a = made[-1].end
    return made
