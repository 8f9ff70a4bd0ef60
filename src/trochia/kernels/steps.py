"""Face of ``core/host/steps.h``: step times of one joint.

In: phases, segments and pool of a trajectory, the joint's row (steps per unit of each axis), a clock.
Out: the tick and direction of every step, window by window; the state is carried, so no cut loses a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import PHASE, ffi, lib, pointer
from trochia.kernels.path import check

if TYPE_CHECKING:
    from numpy.typing import NDArray

GREATEST_TICK = 2**50  #: beyond it a tick no longer fits the fraction of a double with room to round
_CHUNK = 1 << 14  # steps a call of C: its outputs stay in the second-level cache


class JointSteps:
    """Steps of one joint along a path, made window by window.

    Parameters
    ----------
    segments, pool
        The path (``core/host/path.h``), checked once and kept.
    row
        Steps per unit of each axis (axes,) [1/mm or 1/degree].
    clock
        Ticks a second [Hz].
    count
        Steps counted where the joint stands at the start.

    Raises
    ------
    ValueError
        For arrays that do not fit together or a clock that is not above zero.
    """

    def __init__(
        self,
        segments: NDArray[np.void],
        pool: NDArray[np.float64],
        row: NDArray[np.float64],
        clock: float,
        count: int,
    ) -> None:
        self._segments = np.ascontiguousarray(segments)
        self._pool = np.ascontiguousarray(pool)
        self._row = np.array(row, dtype=np.float64)
        check(self._segments, self._pool, self._row.size)
        if not clock > 0.0 or not np.isfinite(self._row).all():
            raise ValueError(f"clock {clock!r} must be above zero and the row finite")
        self._state = ffi.new("trochia_step_state *")
        self._job = ffi.new("trochia_step_job *")
        self._job.segments = pointer(self._segments, "trochia_segment *")
        self._job.pool = pointer(self._pool, "double *")
        self._job.row = pointer(self._row, "double *")
        self._job.axes = self._row.size
        self._job.clock = clock
        self._state.count = count
        self._phases = np.empty(0, dtype=PHASE)
        self._ticks = np.empty(_CHUNK, dtype=np.int64)
        self._directions = np.empty(_CHUNK, dtype=np.int8)

    @property
    def count(self) -> int:
        """Steps made so far, signed: the joint's position [steps]."""
        return int(self._state.count)

    def load(self, phases: NDArray[np.void]) -> None:
        """Take the phases to work next; they follow those before."""
        if phases.dtype != PHASE:
            raise ValueError("steps need PHASE rows")
        moving = phases[phases["flags"] & 1 == 0]
        if moving.size and int(moving["segment"].max()) >= self._segments.size:
            raise ValueError("a phase names a segment that is not there")
        if phases.size and not (phases["t"][-1] + phases["duration"][-1]) * self._job.clock < GREATEST_TICK:
            raise ValueError(f"the program is longer than {GREATEST_TICK} ticks")
        self._phases = np.ascontiguousarray(phases)
        self._job.phases = pointer(self._phases, "trochia_phase *")
        self._job.phase_count = self._phases.size
        self._state.phase = 0
        self._state.tau = 0.0

    def until(self, tick: float = np.inf) -> tuple[NDArray[np.int64], NDArray[np.int8]]:
        """Return ticks and directions (+1, -1) of the steps up to ``tick``, in order."""
        self._job.until = tick
        ticks: list[NDArray[np.int64]] = []
        directions: list[NDArray[np.int8]] = []
        full = True
        while full:
            made = lib.trochia_steps(
                self._job, self._state, _CHUNK, pointer(self._ticks, "int64_t *"),
                pointer(self._directions, "int8_t *"),
            )  # fmt: skip
            ticks.append(self._ticks[:made].copy())
            directions.append(self._directions[:made].copy())
            full = bool(self._state.full)
        if len(ticks) == 1:
            return ticks[0], directions[0]
        return np.concatenate(ticks), np.concatenate(directions)
