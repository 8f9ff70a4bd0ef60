"""How a live backend runs through its queue: from tick to tick, at a rate that slows to 0 when it must.

In: ticks.  Out: what the joints are told at each.  The rate is 1 but where motion is being stopped from here: by a
watched input, by the host's silence, or because the queue runs low and does not end at rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.backends.queue import Queue
from trochia.backends.segments import SAME_TIME

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.backends.segments import Segments


class Told(NamedTuple):
    """What happened over some ticks.

    ``commanded`` are joint positions after each tick (ticks, joints); ``velocity`` (joints,), ``line`` and ``power``
    are those of the last.  ``executed`` is stream time (ticks,), ``speeds`` are velocities (ticks, joints), ``lines``
    and ``powers`` those of each tick (ticks,).
    """

    ticks: int
    commanded: NDArray[np.float64]
    velocity: NDArray[np.float64]
    line: int
    power: float
    executed: NDArray[np.float64]
    speeds: NDArray[np.float64]
    lines: NDArray[np.uint32]
    powers: NDArray[np.float32]


class Executor:
    """Queue, rate and stream time.

    Parameters
    ----------
    position
        Where the joints are (joints,).
    period
        Of a tick [s].

    Attributes
    ----------
    executed
        Stream time run through [s].
    rate
        Stream time a second.
    braking
        Whether motion is being stopped from here.
    """

    def __init__(self, position: NDArray[np.float64], period: float) -> None:
        self.queue = Queue(position)
        self.period = period
        self.executed = 0.0
        self.rate = 1.0
        self.braking = False

    @property
    def moving(self) -> bool:
        """Whether there is anything to run through."""
        return len(self.queue.held) > 0 and self.queue.end > self.executed + SAME_TIME

    @property
    def commanded(self) -> NDArray[np.float64]:
        """Where the joints are told to be (joints,)."""
        return self.queue.at(np.array([self.executed])).position[0]

    def add(self, segments: Segments, at: float) -> None:
        """Queue segments from stream time ``at`` on; see :meth:`trochia.backends.queue.Queue.add`."""
        was_moving = self.moving
        self.queue.add(segments, at, self.executed)
        if not was_moving:
            self.rate, self.braking = 1.0, False

    def halt(self) -> None:
        """Be at rest where the joints are told to be now, at once."""
        self.queue.clear(self.commanded, self.executed)
        self.braking = False

    def run(self, ticks: int, *, one: bool = False) -> Told:
        """Run through up to so many ticks (at most one if ``one``), at least one, while moving."""
        count = 1 if one or self.braking or self.rate < 1.0 else self._steady(ticks)
        self._slew()
        u = np.minimum(self.executed + self.rate * self.period * np.arange(1, count + 1), self.queue.end)
        row, position, velocity = self.queue.at(u)
        self.executed = float(u[-1])
        lines, powers, speeds = self.queue.held.line[row], self.queue.held.power[row], velocity * self.rate
        told = Told(count, position, speeds[-1], int(lines[-1]), float(powers[-1]), u, speeds, lines, powers)
        if self.rate == 0.0:
            self.halt()  # what is queued is the controller's to plan anew
        return told

    def _steady(self, ticks: int) -> int:
        """Return for how many ticks, at least 1, the rate surely stays 1."""
        if self.queue.ends_at_rest:
            return max(1, min(ticks, int((self.queue.end - self.executed) / self.period) + 1))
        count = ticks
        while count > 1 and self.queue.stop_in_hand(self.executed + (count + 1) * self.period) < 1.0:
            count //= 2
        return max(count, 1)

    def _slew(self) -> None:
        """Change the rate over one tick, as far as the row under way lets it."""
        if not self.braking and self.rate >= 1.0 and self.queue.ends_at_rest:
            return
        step = self.queue.slew(self.executed) * self.period
        low = self.queue.stop_in_hand(self.executed + self.rate * self.period) <= self.rate
        if self.braking or low:
            self.rate = max(self.rate - step, 0.0)
        elif self.rate < 1.0:
            self.rate = min(self.rate + step, 1.0)
