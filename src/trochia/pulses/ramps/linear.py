"""Speed rising linearly in time, set anew by a second timer and constant in between (S1-F32).

Between two settings the speed is the mean of the exact law there, so the motor stands where that law has it at each
setting, and the whole time is the exact one.  A ramp's settings are evenly spaced and at most ``demand.update`` apart,
which keeps a move with equal ramps the same both ways.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.pulses.ramps.exact import Even, total
from trochia.pulses.ramps.leg import peak_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.ramps.demand import Demand

_MOST = 4_000_000  # settings of the speed in a ramp


def delays(demand: Demand) -> NDArray[np.float64]:
    """Return the delay before each step (steps,) [s].

    Raises
    ------
    LimitError
        For a ramp of more settings than can be held.
    """
    up, down = Even(demand.rising), Even(demand.falling)
    peak = peak_speed(up, down, demand.steps, demand.speed)
    whole = total(demand)
    rising, falling = (_settings(leg.duration(peak), demand.update) for leg in (up, down))
    left = falling[::-1]
    instants = np.concatenate((rising, whole - left))
    places = np.concatenate((0.5 * demand.rising * rising**2, demand.steps - 0.5 * demand.falling * left**2))
    # where the move is short the two ramps meet, and the last bit must not turn them round
    instants, places = np.maximum.accumulate(instants), np.maximum.accumulate(places)
    return np.diff(np.interp(np.arange(demand.steps + 1, dtype=np.float64), places, instants))


def _settings(duration: float, update: float) -> NDArray[np.float64]:
    """Return the instants of a ramp at which the speed is set, from 0 to its end (n,) [s]."""
    count = max(math.ceil(duration / update), 2)
    if count > _MOST:
        raise LimitError(
            f"setting the speed every {update:g} s takes {count} settings in a ramp of {duration:g} s; at most {_MOST}",
            hint=f"Set it every {duration / _MOST:.2g} s or more.",
        )
    return np.linspace(0.0, duration, count + 1)
