"""How step pulses are timed: exactly, or in whole milliseconds as the motor shield's library waits.

In: a rate and a number of steps.  Out: the instants of the pulses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.pulses.latch import STEP_WORK

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Timing:
    """A way of timing: ``times`` gives the instants (steps + 1,) [s] for a step period [s]; the last is the end."""

    name: str
    times: Callable[[float, int], Floats]


def exact(period: float, steps: int) -> Floats:
    """Return pulses evenly spaced, and the end (steps + 1,) [s]."""
    return period * np.arange(steps + 1, dtype=np.float64)


def millisecond(period: float, steps: int) -> Floats:
    """Return pulses after waits of whole milliseconds, and the end (steps + 1,) [s].

    The remainder is carried to the next wait, so the mean rate is right and single waits are up to 1 ms off: at 200
    steps a turn 150 rpm are even (2 ms), 200 rpm are 1 and 2 ms in turn.
    """
    micros = int(period * 1e6 + 1e-6)
    done = np.arange(steps + 1, dtype=np.int64) * micros
    return (done // 1000).astype(np.float64) * 1e-3


def shield(period: float, steps: int) -> Floats:
    """Return pulses after waits of whole milliseconds and the work of each step (steps + 1,) [s].

    The wait counts from the end of the step's work: every step takes ``pulses.latch.STEP_WORK`` longer than asked, and
    200 rpm come out as 178.
    """
    return millisecond(period, steps) + STEP_WORK * np.arange(steps + 1)


TIMINGS = {
    timing.name: timing
    for timing in (
        Timing(name="exact", times=exact),
        Timing(name="millisecond", times=millisecond),
        Timing(name="shield", times=shield),
    )
}
