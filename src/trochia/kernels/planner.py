"""Face of ``core/host/plan.h``: trapezoid profiles over a path.

In: segments and coefficients, limits, rests.  Out: pieces (``PIECE``); phases, states, times and peaks from them.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import SEGMENT, dtype_of, ffi, lib, pointer
from trochia.kernels.limits import limits_struct, rising_rests
from trochia.kernels.phases import blocks, states

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

PIECE = dtype_of("trochia_piece")
_LEAST_ROOM = 4


class Planned:
    """What the pass over one path came to: its pieces, and readings of them; arrays stay alive with it.

    Parameters
    ----------
    segments, pool
        The path, already checked.
    matrix
        Rows of limited quantities over the axes (rows, axes), the unit matrix first.
    velocity, acceleration
        Limit of each row (rows,).
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
        caps: tuple[float, float],
        linear: int,
        rests: tuple[NDArray[np.uint64], NDArray[np.float64]],
    ) -> None:
        axes = matrix.shape[1]
        self._segments, self._pool, self._axes = segments, pool, axes
        self._rests = rising_rests(rests)
        self._limits = limits_struct(matrix, linear, caps, velocity=velocity, acceleration=acceleration)
        if segments.dtype != SEGMENT:
            raise ValueError("a path is SEGMENT rows")
        count = lib.trochia_plan_count(*self._path(), axes, len(segments))
        self.pieces = np.empty(count, dtype=PIECE)
        self.duration: float = lib.trochia_plan(
            *self._path(), len(segments), self._limits, *self._rest(), self._piece(), count
        )
        self.pieces.setflags(write=False)

    def _path(self) -> tuple[Any, Any]:
        return pointer(self._segments, "trochia_segment *"), pointer(self._pool, "double *")

    def _piece(self) -> Any:  # noqa: ANN401 - a cffi pointer has no Python type
        return pointer(self.pieces, "trochia_piece *")

    def _rest(self) -> tuple[Any, Any, int]:
        where, seconds = self._rests
        return pointer(where, "uint64_t *"), pointer(seconds, "double *"), len(where)

    def phases(self, size: int, memory: Callable[[int], NDArray[np.void]] | None = None) -> Iterator[NDArray[np.void]]:
        """Yield phases in order, at most ``size`` (at least 4) a block (PHASE,); ``memory`` gives that of a block."""
        if size < _LEAST_ROOM:
            raise ValueError(f"a block of phases needs room for {_LEAST_ROOM}, not {size}")
        cursor = ffi.new("trochia_phase_cursor *")
        segments, _ = self._path()
        fill = partial(lib.trochia_plan_phases, segments, self._piece(), len(self.pieces), *self._rest(), cursor)
        yield from blocks(fill, size, memory)

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return the state at each time [s], clamped to the ends (times,) of PHASE; needs at least one piece."""
        if not self.pieces.size:
            raise ValueError("a path without motion has no states")
        segments, _ = self._path()
        return states(partial(lib.trochia_plan_states, segments, self._piece(), len(self.pieces)), times)

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves takes (moves,) [s]; a blend counts to the move it enters."""
        if self._segments.size and int(self._segments["move"].max()) >= moves:
            raise ValueError("the path has more moves than the program")
        out = np.zeros(moves)
        segments, _ = self._path()
        lib.trochia_plan_move_times(segments, self._piece(), len(self.pieces), pointer(out, "double *"))
        return out

    def peaks(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the greatest |velocity| and |acceleration| of each limited row, (rows,) each."""
        velocity, acceleration = np.zeros(self._limits.rows), np.zeros(self._limits.rows)
        lib.trochia_plan_peaks(
            *self._path(), self._limits, self._piece(), len(self.pieces),
            pointer(velocity, "double *"), pointer(acceleration, "double *"),
        )  # fmt: skip
        return velocity, acceleration
