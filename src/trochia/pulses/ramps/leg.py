"""A move from two legs: speed up, hold, slow down; or up and down where the move is short.

In: two legs, each a law of motion from rest.  Out: when each step happens.  A braking leg is a leg run backwards, so
both are asked the same questions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_HALVINGS = 200  # of the interval that holds a short move's peak; it stops when floats do


class Leg(Protocol):
    """A law of motion from rest."""

    def length(self, speed: float) -> float:
        """Return the steps (with a fraction) until ``speed`` [steps/s] is reached."""
        ...

    def duration(self, speed: float) -> float:
        """Return the time until then [s]."""
        ...

    def times(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return when each place (n,) [steps] is reached [s]."""
        ...


def peak_speed(up: Leg, down: Leg, steps: float, speed: float) -> float:
    """Return the speed the move gets to [steps/s]: ``speed``, or less where both legs do not fit (S1-F43)."""
    if up.length(speed) + down.length(speed) <= steps:
        return speed
    low, high = 0.0, speed
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if up.length(middle) + down.length(middle) <= steps:
            low = middle
        else:
            high = middle
    return low


def step_times(up: Leg, down: Leg, steps: int, speed: float) -> NDArray[np.float64]:
    """Return the time of the start and of each step (steps + 1,) [s]."""
    peak = peak_speed(up, down, steps, speed)
    begin, brake = up.length(peak), steps - down.length(peak)
    until = up.duration(peak) + max(brake - begin, 0.0) / peak
    places = np.arange(steps + 1, dtype=np.float64)
    times = up.duration(peak) + (places - begin) / peak
    rising, falling = places < begin, places > brake
    times[rising] = up.times(places[rising])
    times[falling] = until + down.duration(peak) - down.times(steps - places[falling])
    return times
