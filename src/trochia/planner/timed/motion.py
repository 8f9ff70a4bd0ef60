"""Pieces as a trajectory.  In: cubics in time, their program and machine.  Out: what every trajectory can tell.

The path's parameter is time itself: a segment of a piece is as long as it lasts, and ds/dt is 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import PHASE, SEGMENT
from trochia.planner.limits import Limits
from trochia.planner.trajectory import Trajectory
from trochia.toolpath import SegmentKind, Toolpath

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.machine.machine import Machine
    from trochia.planner.timed.pieces import Pieces
    from trochia.program import Program


class TimedSchedule:
    """One phase a piece, with ds/dt = 1; a piece that stays where it is counts as a rest."""

    __slots__ = ("_limits", "_moves", "_phases", "_pieces")

    jerk_limited = True
    by_curves = False

    def __init__(self, pieces: Pieces, limits: Limits, moves: NDArray[np.int64]) -> None:
        self._pieces, self._limits, self._moves = pieces, limits, moves
        phases = np.zeros(len(pieces.durations), dtype=PHASE)
        phases["t"], phases["duration"] = pieces.starts, pieces.durations
        phases["segment"] = np.arange(len(phases))
        still = ~pieces.coefficients[:, 1:].any(axis=(1, 2))
        phases["v"], phases["flags"] = ~still, still
        self._phases = phases

    @property
    def duration(self) -> float:
        """From first motion or rest to last [s]."""
        return self._pieces.duration

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield all phases in order in blocks of at most ``size`` (PHASE,); they are there, and need no ``memory``."""
        del memory
        for first in range(0, len(self._phases), size):
            yield self._phases[first : first + size]

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return segment, s and v at each time [s], clamped to the ends (times,) of PHASE."""
        row = np.clip(np.searchsorted(self._phases["t"], times, side="right") - 1, 0, len(self._phases) - 1)
        out = self._phases[row]
        out["s"] = np.clip(times - out["t"], 0.0, out["duration"]) * out["v"]
        outside = (times < 0.0) | (times > self.duration)
        out["v"][outside], out["flags"][outside] = 0.0, 1
        out["t"] = times
        return out

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves is in motion (moves,) [s]."""
        moving = self._phases["flags"] == 0
        return np.bincount(self._moves[moving], self._phases["duration"][moving], moves).astype(np.float64)

    def peaks(self) -> dict[str, NDArray[np.float64]]:
        """Return the greatest |velocity|, |acceleration| and |jerk| of each row of limits (rows,), exactly."""
        greatest = self._pieces.peaks(self._limits.matrix).max(axis=1)
        return dict(zip(("velocity", "acceleration", "jerk"), greatest, strict=True))

    def over_limit(self) -> NDArray[np.bool_]:
        """Return that nothing is slowed: times are kept (segments,)."""
        return np.zeros(len(self._phases), dtype=np.bool_)


def plan_timed(pieces: Pieces, program: Program, machine: Machine) -> Trajectory:
    """Return the trajectory of moves given by time; :func:`excesses` tells which limits it does not keep.

    Parameters
    ----------
    pieces
        Columns are the machine's axes; moves are rows of the program's.

    Raises
    ------
    ValueError
        When they are not.
    """
    letters = "".join(axis.name for axis in machine.axes)
    count, _, axes = pieces.coefficients.shape
    if axes != len(letters) or (len(pieces.moves) and int(pieces.moves.max()) >= len(program.moves)):
        raise ValueError("pieces have a column for each axis of the machine, and moves of the program")
    segments = np.zeros(count, dtype=SEGMENT)
    segments["length"], segments["speed_limit"], segments["kind"] = pieces.durations, 1.0, SegmentKind.CUBIC
    segments["data"], segments["move"] = 4 * axes * np.arange(count), pieces.moves
    start = pieces.coefficients[0, 0].copy()
    path = Toolpath(axes=letters, start=start, segments=segments, pool=pieces.coefficients.ravel().copy())
    limits = Limits.of(machine)
    schedule = TimedSchedule(pieces, limits, pieces.moves)
    still = float(pieces.durations.sum() - schedule.move_times(len(program.moves)).sum())
    return Trajectory(
        program=program, path=path, limits=limits, profile="timed", schedule=schedule,
        times={"motion": pieces.duration - still, "dwell": still, "spindle": 0.0, "tool": 0.0},
        duration=pieces.duration,
    )  # fmt: skip
