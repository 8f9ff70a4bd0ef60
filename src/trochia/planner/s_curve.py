"""S-curve profile: jerk is limited, acceleration does not jump.  In: path, limits, rests.  Out: its Schedule, from C.

Ramps run over as many segments as they need; ``core/host/scurve.c`` says how they are found.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from trochia.errors import LimitError
from trochia.kernels.scurve import Ramps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.planner.limits import Limits
    from trochia.planner.rests import Rests
    from trochia.toolpath import Toolpath


class SCurveSchedule:
    """Knots between which jerk is constant; phases are made from them when asked for.

    Raises
    ------
    LimitError
        When an axis has no jerk limit.
    """

    __slots__ = ("_ramps",)

    continuity: ClassVar[int] = 2
    jerk_limited = True
    by_curves: ClassVar[bool] = False

    def __init__(self, path: Toolpath, limits: Limits, rests: Rests) -> None:
        lacking = [name for name, jerk in zip(limits.names, limits.jerk, strict=True) if not np.isfinite(jerk)]
        lacking = [name for name in lacking if name.startswith("axis")]
        if lacking:
            raise LimitError(
                f"the profile s-curve needs a jerk limit for {lacking[0]}",
                hint='Give it in the machine file, as jerk = "20000 mm/s³", or plan with the profile trapezoid.',
            )
        self._ramps = Ramps(
            path.segments, path.pool, matrix=limits.matrix, velocity=limits.velocity,
            acceleration=limits.acceleration, jerk=limits.jerk, linear=limits.linear,
            caps=(limits.path_velocity, limits.path_acceleration, limits.path_jerk),
            rests=(rests.segments, rests.seconds),
        )  # fmt: skip

    @property
    def duration(self) -> float:
        """From first motion or rest to last [s]."""
        return self._ramps.duration

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield all phases in order in blocks of at most ``size`` (PHASE,), in ``memory`` if there is any."""
        return self._ramps.phases(size, memory)

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return segment, s, v, a and j at each time [s], clamped to the ends (times,) of PHASE."""
        return self._ramps.states(times)

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves is in motion (moves,) [s]."""
        return self._ramps.move_times(moves)

    def peaks(self) -> dict[str, NDArray[np.float64]]:
        """Return the greatest |velocity|, |acceleration| and |jerk| of each row of limits (rows,)."""
        velocity, acceleration, jerk = self._ramps.peaks()
        return {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}

    def over_limit(self) -> NDArray[np.bool_]:
        """Return in which segments a velocity limit lies below the programmed feed (segments,)."""
        return self._ramps.over
