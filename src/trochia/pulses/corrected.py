"""Steps of joints whose errors are corrected: not of the path itself, but of where their motors are told to be.

In: a way of motors over time.  Out: steps, window by window, as :class:`trochia.kernels.steps.JointSteps` gives them.
Cubics through four places each, a millisecond long at most, follow the way; what they leave is far below a step.  A
joint stands on the nearest whole step, as behind a live board, and not on the last it passed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.link import cubic_steps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.motor_way import MotorWay

ROW = 0.001  #: longest cubic [s]
_THIRDS = np.arange(4) / 3.0
_FIT = np.linalg.inv(_THIRDS[:, None] ** np.arange(4))  #: coefficients by places at thirds of a row


class CorrectedWay:
    """Cubics of all joints over windows of time; the last window is kept, for every joint asks for it."""

    def __init__(self, way: MotorWay) -> None:
        self._way = way
        self._window: tuple[float, float] | None = None
        self._edges = np.zeros(0)
        self._rows = np.zeros((0, 0, 4))

    def rows(
        self, begin: float, end: float, breaks: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return edges (rows + 1,) [s] and coefficients by the share of a row (rows, joints, 4) between two times.

        ``breaks`` are times at which a row must end.
        """
        if self._window != (begin, end):
            inside = breaks[(breaks > begin) & (breaks < end)]
            even = np.linspace(begin, end, max(int(np.ceil((end - begin) / ROW)), 1) + 1)
            edges = np.unique(np.concatenate([even, inside]))
            h = np.diff(edges)
            places = self._way.at((edges[:-1, None] + h[:, None] * _THIRDS).ravel())
            self._rows = np.einsum("kt,rtj->rjk", _FIT, places.reshape(len(h), 4, -1))
            self._edges, self._window = edges, (begin, end)
        return self._edges, self._rows


class CorrectedSteps:
    """Steps of one joint.

    Parameters
    ----------
    joint
        Its number.
    per_unit
        Steps a mm or degree; 0 of a servo.
    clock
        Ticks a second [Hz].
    count
        Steps counted where it stands at the start.
    """

    def __init__(self, way: CorrectedWay, joint: int, per_unit: float, clock: float, count: int) -> None:
        self._way, self._joint, self._per_unit, self._clock = way, joint, per_unit, clock
        self.count = count
        self._at = self._end = 0.0
        self._breaks = np.zeros(0)

    def load(self, phases: NDArray[np.void]) -> None:
        """Take the phases to work next; they follow those before."""
        self._at = float(phases["t"][0])
        self._end = float(phases["t"][-1] + phases["duration"][-1])
        self._breaks = phases["t"].astype(np.float64)

    def until(self, tick: float = np.inf) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
        """Return ticks and directions (+1, -1) of the steps up to ``tick``, in order."""
        end = min(tick / self._clock, self._end)
        if self._per_unit == 0.0 or end <= self._at:
            return np.empty(0, np.int64), np.empty(0, np.int8)
        edges, rows = self._way.rows(self._at, end, self._breaks)
        ticks = edges * self._clock
        steps = rows[:, self._joint] * self._per_unit / np.diff(ticks)[:, None] ** np.arange(4)
        made, ways = cubic_steps(steps, ticks, self.count)
        self._at = end
        self.count += int(ways.sum(dtype=np.int64))
        return made, ways
