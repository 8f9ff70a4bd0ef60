"""A velocity profile: the delay before each step, and every column of its table (S1-F46).

In: delays [s] from one of the laws.  Out: times, ticks, speeds, and the acceleration found back from the delays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.ramps.demand import Demand

    Floats = NDArray[np.float64]

#: columns of the table: key, title, decimals a person is shown
COLUMNS: tuple[tuple[str, str, int], ...] = (
    ("time_s", "time [s]", 5),
    ("delay_s", "delay [s]", 5),
    ("n", "n", 0),
    ("elapsed_ticks", "elapsed [ticks]", 0),
    ("ticks", "ticks", 0),
    ("speed_rad_s", "rad/s", 3),
    ("speed_rpm", "rpm", 1),
    ("speed_steps_s", "steps/s", 1),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """The delays (steps,) [s] a law gives for a demand; step n is made at the end of delay n, n from 0."""

    law: str
    title: str
    demand: Demand
    delays: Floats

    def __post_init__(self) -> None:
        self.delays.flags.writeable = False

    @property
    def duration(self) -> float:
        """The whole time [s]."""
        return math.fsum(self.delays.tolist())

    @property
    def times(self) -> Floats:
        """The end of each delay, which is when its step is made (steps,) [s]."""
        return np.cumsum(self.delays)

    @property
    def speeds(self) -> Floats:
        """The speed of each step: one over its delay (steps,) [steps/s]."""
        return 1.0 / self.delays

    @property
    def peak(self) -> float:
        """The greatest speed [steps/s]."""
        return float(self.speeds.max())

    @property
    def accelerations(self) -> Floats:
        """The acceleration between neighbouring delays (steps - 1,) [steps/s²] (S1 E16)."""
        before, after = self.delays[:-1], self.delays[1:]
        return 2.0 * (before - after) / (before * after * (before + after))

    def columns(self) -> dict[str, Floats | NDArray[np.int64]]:
        """Return the table by column, each (steps,); ticks are real numbers, as the laws give them."""
        clock, turn = self.demand.clock, self.demand.steps_per_turn
        times = self.times
        return {
            "time_s": times,
            "delay_s": self.delays,
            "n": np.arange(times.size),
            "elapsed_ticks": np.concatenate(((0.0,), times[:-1])) * clock,
            "ticks": self.delays * clock,
            "speed_rad_s": self.speeds * self.demand.step_angle,
            "speed_rpm": 60.0 * self.speeds / turn,
            "speed_steps_s": self.speeds,
        }
