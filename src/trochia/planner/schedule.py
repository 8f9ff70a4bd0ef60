"""The seam between velocity profiles and the trajectory: what a profile must be able to tell.

In: a path, limits, rests.  Out: a Schedule, which gives speed along the path as phases of constant jerk.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import numpy as np
    from numpy.typing import NDArray

    from trochia.planner.limits import Limits
    from trochia.planner.rests import Rests
    from trochia.toolpath import Toolpath


class Schedule(Protocol):
    """Speed along one path over time."""

    @property
    def duration(self) -> float:
        """From first motion or rest to last [s]."""
        ...

    @property
    def jerk_limited(self) -> bool:
        """Whether acceleration is continuous; where not, jerk has no peak to speak of."""
        ...

    @property
    def by_curves(self) -> bool:
        """Whether acceleration follows the limits' curves by speed; where not, it keeps the least of each."""
        ...

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield all phases in order, without a gap, in blocks of at most ``size`` (PHASE,).

        ``memory`` gives room for so many or more, for a block each; None: it is new.
        """
        ...

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return segment, s, v, a and j at each time [s], clamped to the ends (times,) of PHASE."""
        ...

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves is in motion (moves,) [s]."""
        ...

    def peaks(self) -> dict[str, NDArray[np.float64]]:
        """Return the greatest |velocity| and |acceleration| (and |jerk| where limited) of each row (rows,)."""
        ...

    def over_limit(self) -> NDArray[np.bool_]:
        """Return in which segments a velocity limit lies below the programmed feed (segments,)."""
        ...


class Profile(Protocol):
    """A way to decide speed: one row of :data:`trochia.planner.PROFILES`."""

    @property
    def continuity(self) -> int:
        """What its path must keep between stops: 1, direction; 2, curvature too (see ``toolpath.build``)."""
        ...

    @property
    def by_curves(self) -> bool:
        """Whether its schedules follow curves of acceleration by speed."""
        ...

    def __call__(self, path: Toolpath, limits: Limits, rests: Rests) -> Schedule:
        """Return the schedule of a path with at least one segment."""
        ...
