"""Face of ``core/host/scurve.h``: speed along a path with limited jerk.

In: segments and coefficients, limits, rests.  Out: knots (``KNOT``); phases, states, times and peaks from them.
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

KNOT = dtype_of("trochia_knot")
LEG = dtype_of("trochia_leg")
STRETCH = dtype_of("trochia_stretch")
_BLOCK = 65536


TRIES = 6  #: plans made before motion stops at every joint beside one that fails
SAME = 1e-10  #: part by which places may be apart at a knot by rounding; a thousand times that for speeds
ROUNDED = 4e-15  #: part of s that sums of it lose: near rest that little way is a speed that is none


class Ramps:
    """What the passes over one path came to: its knots, and readings of them; arrays stay alive with it.

    Parameters
    ----------
    segments, pool
        The path, already checked; at least one segment.
    matrix
        Rows of limited quantities over the axes (rows, axes), the unit matrix first.
    velocity, acceleration, jerk
        Limit of each row (rows,).
    caps
        Greatest velocity, acceleration and jerk of the vector X Y Z; infinity where there is none.
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
        jerk: NDArray[np.float64],
        caps: tuple[float, float, float],
        linear: int,
        rests: tuple[NDArray[np.uint64], NDArray[np.float64]],
    ) -> None:
        if not np.isfinite(jerk[: matrix.shape[1]]).all():
            raise ValueError("every axis needs a jerk limit")
        if segments.dtype != SEGMENT or not len(segments):
            raise ValueError("a path is SEGMENT rows, at least one")
        self._segments, self._pool = segments, pool
        self._limits = limits_struct(matrix, linear, caps, velocity=velocity, acceleration=acceleration, jerk=jerk)
        self._plan(*rising_rests(rests))

    def _plan(self, where: NDArray[np.uint64], seconds: NDArray[np.float64]) -> None:
        """Plan, and look at the joins: one in some ten thousands of programs has a join of the two passes that fails.

        Motion then stops beside it, which both passes agree on; if that does not do, farther from it too, and at last
        at every joint between the two stops that it lies between.
        """
        for attempt in range(TRIES + 1):
            self._pass(where, seconds)
            broken = self.knots["segment"][_jumps(self.knots)].tolist()
            if not broken or attempt == TRIES:
                break
            segments = self._segments.copy()
            stops = np.flatnonzero(segments["stop"])
            for row in broken:
                low, high = max(row - 1 - attempt, 0), row + 1 + attempt
                if attempt == TRIES - 1:
                    after = int(np.searchsorted(stops, row))
                    low = int(stops[after - 1]) if after else 0
                    high = int(stops[after]) if after < len(stops) else len(segments)
                segments["stop"][low:high] = 1
            self._segments = segments
        self.knots.setflags(write=False)

    def _pass(self, where: NDArray[np.uint64], seconds: NDArray[np.float64]) -> None:
        count = len(self._segments)
        stretch_count = lib.trochia_scurve_count(*self._path(), self._limits.axes, count)
        stretches = np.empty(stretch_count + 1, dtype=STRETCH)
        rows = pointer(stretches, "trochia_stretch *")
        lib.trochia_scurve_load(*self._path(), count, self._limits, rows)
        room, made = 4 * stretch_count + len(where) + 64, 0
        while not made:
            legs, self.knots = np.empty(room, dtype=LEG), np.empty(room, dtype=KNOT)
            made = lib.trochia_scurve(
                rows, stretch_count, pointer(where, "uint64_t *"), pointer(seconds, "double *"), len(where),
                pointer(legs, "trochia_leg *"), room, self._knot(), room,
            )  # fmt: skip
            room *= 2
        self.knots.resize(made, refcheck=False)
        self._starts = np.empty(count + 1)
        lib.trochia_scurve_starts(rows, stretch_count, pointer(self._starts, "double *"))
        self.over = np.zeros(count, dtype=np.bool_)
        stretches = stretches[:stretch_count]
        self.over[stretches["segment"][stretches["over"] != 0]] = True

    def _path(self) -> tuple[Any, Any]:
        return pointer(self._segments, "trochia_segment *"), pointer(self._pool, "double *")

    def _knot(self) -> Any:  # noqa: ANN401 - a cffi pointer has no Python type
        return pointer(self.knots, "trochia_knot *")

    def _read(self) -> tuple[Any, int, Any, int]:
        """Return what readings begin with: where each segment begins, and the knots."""
        return pointer(self._starts, "double *"), len(self._segments), self._knot(), len(self.knots)

    @property
    def duration(self) -> float:
        """Whole time, rests included [s]."""
        return float(self.knots["t"][-1])

    def phases(
        self, size: int = _BLOCK, memory: Callable[[int], NDArray[np.void]] | None = None
    ) -> Iterator[NDArray[np.void]]:
        """Yield phases in order, at most ``size`` a block (PHASE,); ``memory`` gives that of a block."""
        if size < 1:
            raise ValueError(f"a block of phases needs room for one, not {size}")
        cursor = ffi.new("trochia_knot_cursor *")
        yield from blocks(partial(lib.trochia_scurve_phases, *self._read(), cursor), size, memory)

    def states(self, times: NDArray[np.float64]) -> NDArray[np.void]:
        """Return the state at each time [s], clamped to the ends (times,) of PHASE."""
        return states(partial(lib.trochia_scurve_states, *self._read()), times)

    def move_times(self, moves: int) -> NDArray[np.float64]:
        """Return the time each of the program's moves takes (moves,) [s]; a blend counts to the move it enters."""
        if int(self._segments["move"].max()) >= moves:
            raise ValueError("the path has more moves than the program")
        out = np.zeros(moves)
        for block in self.phases():
            moving = block[block["flags"] == 0]
            out += np.bincount(self._segments["move"][moving["segment"]], moving["duration"], moves)
        return out

    def peaks(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the greatest |velocity|, |acceleration| and |jerk| of each limited row, (rows,) each."""
        found = np.zeros((3, self._limits.rows))
        for block in self.phases():
            lib.trochia_scurve_peaks(
                *self._path(), self._limits, pointer(block, "trochia_phase *"), len(block),
                *(pointer(row, "double *") for row in found),
            )  # fmt: skip
        return found[0], found[1], found[2]


def _jumps(knots: NDArray[np.void]) -> NDArray[np.intp]:
    """Return the knots from which motion does not arrive at the next one's place and speed (k,)."""
    here, there = knots[:-1], knots[1:]
    t = there["t"] - here["t"]
    v = here["v"] + t * (here["a"] + 0.5 * t * here["j"])
    way = t * (here["v"] + t * (0.5 * here["a"] + t * here["j"] / 6.0))
    off = np.abs(here["s"] + way - there["s"]) > SAME * (1.0 + there["s"])
    nothing = np.cbrt(4.5 * np.abs(here["j"]) * (ROUNDED * there["s"]) ** 2)
    off |= np.abs(v - there["v"]) > SAME * (1.0 + there["v"]) * 1e3 + nothing
    off &= (here["flags"] == 0) & (np.arange(len(t)) < len(t) - 1)
    return np.flatnonzero(off)
