"""Constant acceleration, exactly: step n at t = √(2 n / a), so its delay is √(2/a) (√(n+1) - √n) (S1 E11 to E13)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.pulses.ramps.leg import step_times

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.ramps.demand import Demand


@dataclass(frozen=True, slots=True)
class Even:
    """The leg of constant acceleration [steps/s²]."""

    acceleration: float

    def length(self, speed: float) -> float:
        """Return v²/(2a) [steps] (S1 E17)."""
        return speed * speed / (2.0 * self.acceleration)

    def duration(self, speed: float) -> float:
        """Return v/a [s]."""
        return speed / self.acceleration

    def times(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return √(2 s / a) [s]."""
        return np.sqrt(2.0 * places / self.acceleration)


def delays(demand: Demand) -> NDArray[np.float64]:
    """Return the delay before each step (steps,) [s]."""
    up, down = Even(demand.rising), Even(demand.falling)
    return np.diff(step_times(up, down, demand.steps, demand.speed))


def total(demand: Demand) -> float:
    """Return the whole time in closed form [s]: N/v + v/(2 a₁) + v/(2 a₂), or of the triangle √(2 N (1/a₁ + 1/a₂))."""
    slowness = 1.0 / demand.rising + 1.0 / demand.falling
    if demand.speed * demand.speed * slowness / 2.0 <= demand.steps:
        return demand.steps / demand.speed + demand.speed * slowness / 2.0
    return math.sqrt(2.0 * demand.steps * slowness)
