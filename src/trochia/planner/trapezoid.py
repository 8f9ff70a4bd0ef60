"""Trapezoid profile: acceleration jumps, velocity does not.  In: path, limits, rests.  Out: its Schedule, made in C.

Every piece of the path keeps |q'' w + q' a| <= A for each row of limits, w = v²; ``core/host/plan_span.c`` says why
that holds everywhere between its ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from trochia.kernels.planner import Planned

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.planner.limits import Limits
    from trochia.planner.rests import Rests
    from trochia.toolpath import Toolpath


class TrapezoidSchedule:
    """Pieces of constant or rising-staying-falling v², kept as five numbers each; phases are made when asked for."""

    __slots__ = ("_planned", "_segments")

    continuity: ClassVar[int] = 1
    jerk_limited = False
    by_curves: ClassVar[bool] = False

    def __init__(self, path: Toolpath, limits: Limits, rests: Rests) -> None:
        self._segments = path.segments
        self._planned = Planned(
            path.segments, path.pool, matrix=limits.matrix, velocity=limits.velocity,
            acceleration=limits.acceleration, caps=(limits.path_velocity, limits.path_acceleration),
            linear=limits.linear, rests=(rests.segments, rests.seconds),
        )  # fmt: skip

    @property
    def duration(self) -> float:
        """From first motion or rest to last [s]."""
        return self._planned.duration

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield all phases in order in blocks of at most ``size`` (PHASE,), in ``memory`` if there is any."""
        return self._planned.phases(size, memory)

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return segment, s, v, a at each time [s], clamped to the ends (times,) of PHASE."""
        return self._planned.states(times)

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves is in motion (moves,) [s]."""
        return self._planned.move_times(moves)

    def peaks(self) -> dict[str, NDArray[np.float64]]:
        """Return the greatest |velocity| and |acceleration| of each row of limits (rows,)."""
        velocity, acceleration = self._planned.peaks()
        return {"velocity": velocity, "acceleration": acceleration}

    def over_limit(self) -> NDArray[np.bool_]:
        """Return in which segments a velocity limit lies below the programmed feed (segments,)."""
        over = np.zeros(len(self._segments), dtype=np.bool_)
        pieces = self._planned.pieces
        over[pieces["segment"][pieces["flags"] != 0]] = True
        return over
