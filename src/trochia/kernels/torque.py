"""Face of ``core/host/plan_torque.h``: speed along a path where acceleration falls with speed.

In: segments and coefficients, limits, knots of rows that have any, rests.  Out: pieces; phases and states from them.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import SEGMENT, dtype_of, ffi, lib, pointer
from trochia.kernels.limits import limits_struct, rising_rests
from trochia.kernels.phases import blocks, states

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

PIECE = dtype_of("trochia_torque_piece")
FALL = dtype_of("trochia_fall")
_ROOM = 4096  #: phases asked for at a time; a piece may make 401
_MOST_KNOTS = 32


class Falling:
    """What the passes over one path came to: its pieces, and readings of them; arrays stay alive with it.

    Parameters
    ----------
    segments, pool
        The path, already checked; at least one segment.
    matrix
        Rows of limited quantities over the axes (rows, axes), the unit matrix first.
    velocity, acceleration
        Limit of each row (rows,); acceleration is not read of rows that have knots.
    knots
        By row: pairs of speed, rising, and acceleration, never rising (knots, 2).
    caps
        Greatest velocity and acceleration of the vector X Y Z; infinity where there is none.
    linear
        Number of leading columns that are X, Y or Z.
    rests
        Segment before which motion rests (rests,), rising, and for how long [s] (rests,).
    """

    def __init__(
        self,
        segments: NDArray[np.void],
        pool: NDArray[np.float64],
        *,
        matrix: NDArray[np.float64],
        velocity: NDArray[np.float64],
        acceleration: NDArray[np.float64],
        knots: Mapping[int, NDArray[np.float64]],
        caps: tuple[float, float],
        linear: int,
        rests: tuple[NDArray[np.uint64], NDArray[np.float64]],
    ) -> None:
        if segments.dtype != SEGMENT or not len(segments):
            raise ValueError("a path is SEGMENT rows, at least one")
        self._segments, self._pool = segments, pool
        self._limits = limits_struct(matrix, linear, caps, velocity=velocity, acceleration=acceleration)
        self._falls = _falls(knots, len(matrix))
        where, seconds = self._rests = rising_rests(rests)
        task = self._task = ffi.new("trochia_torque_task *")
        task.segments, task.pool = pointer(segments, "trochia_segment *"), pointer(pool, "double *")
        task.limits, task.falls = self._limits, pointer(self._falls, "trochia_fall *")
        task.rest_segments, task.rest_seconds = pointer(where, "uint64_t *"), pointer(seconds, "double *")
        task.segment_count, task.rests = len(segments), len(where)
        count = lib.trochia_plan_count(task.segments, task.pool, matrix.shape[1], len(segments))
        self.pieces = np.zeros(count, dtype=PIECE)
        self.duration: float = lib.trochia_torque_plan(task, self._piece(), count)
        self.pieces.setflags(write=False)

    def _piece(self) -> Any:  # noqa: ANN401 - a cffi pointer has no Python type
        return pointer(self.pieces, "trochia_torque_piece *")

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield phases in order, at most ``size`` (at least 1) a block (PHASE,); ``memory`` gives that of a block."""
        if size < 1:
            raise ValueError(f"a block of phases needs room for one, not {size}")
        cursor = ffi.new("trochia_phase_cursor *")
        fill = partial(lib.trochia_torque_phases, self._task, self._piece(), len(self.pieces), cursor)
        for block in blocks(fill, _ROOM, memory):
            for first in range(0, len(block), size):
                yield block[first : first + size]

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return the state at each time [s], clamped to the ends (times,) of PHASE."""
        return states(partial(lib.trochia_torque_states, self._task, self._piece(), len(self.pieces)), times)


def _falls(knots: Mapping[int, NDArray[np.float64]], rows: int) -> NDArray[np.void]:
    """Return the knots of every row as C reads them (rows,); ValueError where they are not in order."""
    falls = np.zeros(rows, dtype=FALL)
    for row, pairs in knots.items():
        if pairs.ndim != 2 or pairs.shape[1] != 2 or not 1 <= len(pairs) <= _MOST_KNOTS or not 0 <= row < rows:
            raise ValueError(f"1 to {_MOST_KNOTS} knots of speed and acceleration, for a row there is")
        speed, acceleration = pairs.T
        if (np.diff(speed) <= 0.0).any() or (np.diff(acceleration) > 0.0).any() or not (acceleration > 0.0).all():
            raise ValueError("speeds rise, accelerations stay above zero and never rise")
        falls[row]["count"] = len(pairs)
        falls[row]["speed"][: len(pairs)], falls[row]["acceleration"][: len(pairs)] = speed, acceleration
    return falls
