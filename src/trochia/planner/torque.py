"""Torque profile: acceleration falls with speed, as a motor's torque does.  In: path, limits, rests.  Out: a Schedule.

Every row of limits keeps |q'' v² + q' a| <= A(|q' v|), A its curve; ``core/host/plan_torque_span.c`` says why that
holds everywhere.  Rows without a curve keep their constant: a machine without any is planned as by trapezoids.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from trochia.kernels import path as kernel
from trochia.kernels.torque import Falling

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.planner.limits import Limits
    from trochia.planner.rests import Rests
    from trochia.toolpath import Toolpath

_BLOCK = 65_536
_PLACES = 5  #: in each phase that peaks are looked for


class TorqueSchedule:
    """Pieces with a speed at their end; ramps and phases are made from them when asked for."""

    __slots__ = ("_falling", "_limits", "_path")

    continuity: ClassVar[int] = 1
    jerk_limited = False
    by_curves: ClassVar[bool] = True

    def __init__(self, path: Toolpath, limits: Limits, rests: Rests) -> None:
        self._path, self._limits = path, limits
        self._falling = Falling(
            path.segments, path.pool, matrix=limits.matrix, velocity=limits.velocity, acceleration=limits.acceleration,
            knots={row: np.array(curve.knots) for row, curve in limits.curves.items()},
            caps=(limits.path_velocity, limits.path_acceleration),
            linear=limits.linear, rests=(rests.segments, rests.seconds),
        )  # fmt: skip

    @property
    def duration(self) -> float:
        """From first motion or rest to last [s]."""
        return self._falling.duration

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield all phases in order in blocks of at most ``size`` (PHASE,), in ``memory`` if there is any."""
        return self._falling.phases(size, memory)

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return segment, s, v, a and j at each time [s], clamped to the ends (times,) of PHASE."""
        return self._falling.states(times)

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves is in motion (moves,) [s]."""
        out = np.zeros(moves)
        for block in self.phases(_BLOCK):
            moving = block[block["flags"] == 0]
            out += np.bincount(self._path.segments["move"][moving["segment"]], moving["duration"], moves)
        return out

    def peaks(self) -> dict[str, NDArray[np.float64]]:
        """Return the greatest |velocity| and |acceleration| of each row of limits (rows,)."""
        path, matrix = self._path, self._limits.matrix
        peaks = np.zeros((2, len(matrix)))
        for phases in self.phases(_BLOCK):
            states = np.repeat(phases, _PLACES)
            tau = np.tile(np.linspace(0.0, 1.0, _PLACES), len(phases)) * states["duration"]
            states["s"] += tau * (states["v"] + tau * (states["a"] / 2 + tau * states["j"] / 6))
            states["v"] += tau * (states["a"] + tau * states["j"] / 2)
            states["a"] += tau * states["j"]
            for order in (1, 2):
                values = np.abs(kernel.sample(path.segments, path.pool, len(path.axes), states, order) @ matrix.T)
                np.maximum(peaks[order - 1], values.max(axis=0), out=peaks[order - 1])
        return {"velocity": peaks[0], "acceleration": peaks[1]}

    def over_limit(self) -> NDArray[np.bool_]:
        """Return in which segments a velocity limit lies below the programmed feed (segments,)."""
        over = np.zeros(len(self._path), dtype=np.bool_)
        pieces = self._falling.pieces
        over[pieces["segment"][pieces["flags"] != 0]] = True
        return over
