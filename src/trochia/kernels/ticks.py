"""Face of ``core/shared/{ramp,speed,segment}.h``: what a chip executes, run on the host by the very same code.

In: whole numbers of ticks.  Out: the interval before each step [ticks].
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import dtype_of, ffi, lib, pointer

if TYPE_CHECKING:
    from numpy.typing import NDArray

SEGMENT = dtype_of("trochia_tick_segment")  #: interval, add, add2, count, stride, flags: 16 bytes
BACKWARDS, PAUSE, SCALE = lib.TROCHIA_SEGMENT_BACKWARDS, lib.TROCHIA_SEGMENT_PAUSE, lib.TROCHIA_SEGMENT_SCALE
COARSEST = lib.TROCHIA_SEGMENT_COARSEST  #: greatest scale of ``add`` and ``add2``
LONGEST = 2**31  #: a ramp lasts less [ticks]
STEEPEST = 2**60  #: greatest C of a ramp [ticks²]
_CHUNK = 512  # segments a call
STATES = {"STOP": lib.TROCHIA_STOP, "ACCEL": lib.TROCHIA_ACCEL, "RUN": lib.TROCHIA_RUN, "DECEL": lib.TROCHIA_DECEL}


class Ramp:
    """Constant acceleration, exact to the tick: T(k) = √(N₀ + k C), to the nearest tick.

    Parameters
    ----------
    per_step
        C = 2 f²/a [ticks²].
    square
        N₀ = (f v/a)² for a start at speed v, 0 from rest [ticks²].

    Raises
    ------
    ValueError
        For figures the core's integers cannot hold.
    """

    def __init__(self, per_step: int, square: int = 0) -> None:
        if not 0 < per_step <= STEEPEST or not 0 <= square < LONGEST**2:
            raise ValueError(f"C must be 1 to 2^60 and N0 below 2^62, not {per_step} and {square}")
        self._ramp = ffi.new("trochia_ramp *")
        self._square = square
        lib.trochia_begin_ramp(self._ramp, per_step, square)

    def up(self, steps: int) -> NDArray[np.uint32]:
        """Return the intervals of the next ``steps`` steps, each faster than the one before (steps,) [ticks].

        Raises
        ------
        ValueError
            When the ramp would last 2³¹ ticks or more.
        """
        square = self._square + steps * self._ramp.per_step
        if steps < 0 or square >= LONGEST**2:
            raise ValueError(f"a ramp lasts less than 2^31 ticks: {steps} more steps do not fit")
        return self._go(steps, 0, square)

    def down(self, steps: int) -> NDArray[np.uint32]:
        """Return the intervals of the next ``steps`` steps, each slower than the one before (steps,) [ticks].

        Raises
        ------
        ValueError
            When rest is reached before.
        """
        square = self._square - steps * self._ramp.per_step
        if steps < 0 or square < 0:
            raise ValueError(f"rest is less than {steps} steps away")
        return self._go(steps, 1, square)

    def _go(self, steps: int, down: int, square: int) -> NDArray[np.uint32]:
        """Run the core."""
        intervals = np.empty(steps, np.uint32)
        lib.trochia_ramp_intervals(self._ramp, down, steps, pointer(intervals, "uint32_t *"))
        self._square = square
        return intervals


def speed_move(
    up_per_step: int, down_per_step: int, counts: tuple[int, int, int], interval: int
) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
    """Return the interval before each step of a move (steps,) [ticks], and the state each was made in (steps,).

    Parameters
    ----------
    up_per_step, down_per_step
        C of either ramp [ticks²].
    counts
        Steps up, at speed, and down.
    interval
        At speed [2⁻⁸ ticks].

    Raises
    ------
    ValueError
        For figures the core's integers cannot hold.
    """
    up, level, down = counts
    fits = min(counts) >= 0 and max(counts) < 2**32 and 0 < interval < 2**32
    fits &= min(up_per_step, down_per_step) > 0 and max(up_per_step, down_per_step) <= STEEPEST
    if not fits or max(up * up_per_step, down * down_per_step) >= LONGEST**2:
        raise ValueError(f"a move's ramps last less than 2^31 ticks; {counts} with {interval} do not fit")
    move = ffi.new("trochia_speed *")
    lib.trochia_begin_speed(move, up_per_step, down_per_step, up, level, down, interval)
    intervals, states = np.empty(sum(counts) + 1, np.uint32), np.empty(sum(counts) + 1, np.uint8)
    made = lib.trochia_speed_intervals(
        move, sum(counts) + 1, pointer(intervals, "uint32_t *"), pointer(states, "uint8_t *")
    )
    return intervals[:made], states[:made]


class SegmentRun:
    """Executes tick segments; the fraction of a tick is carried from call to call."""

    def __init__(self) -> None:
        self._run = ffi.new("trochia_segment_run *")

    @property
    def fraction(self) -> int:
        """What is carried [2⁻⁸ ticks]."""
        return int(self._run.fraction)

    def intervals(self, segments: NDArray[np.void]) -> NDArray[np.uint32]:
        """Return the interval before every step of ``segments`` (segments,), pauses included (steps,) [ticks].

        Raises
        ------
        ValueError
            For a segment without steps or without stride.
        """
        rows = np.ascontiguousarray(segments, SEGMENT)
        if rows.size and (rows["count"].min() < 1 or rows["stride"].min() < 1):
            raise ValueError("a segment has at least one step, and a stride of at least one")
        steps = int(rows["count"].sum(dtype=np.int64))
        intervals = np.empty(steps, np.uint32)
        made = lib.trochia_segment_intervals(
            self._run, pointer(rows, "trochia_tick_segment *"), rows.size, steps, pointer(intervals, "uint32_t *")
        )
        return intervals[:made]


class SegmentFit:
    """Step ticks to tick segments, as few as keep every step within a tolerance of its tick.

    What the executor will make of the segments is followed exactly, so deviations do not add up.

    Parameters
    ----------
    now
        Where the executor stands [ticks]; its fraction of a tick is 0.
    tolerance
        [ticks]; in any case half of either interval beside a step.
    """

    def __init__(self, now: int = 0, *, tolerance: float = 16.0) -> None:
        if not 1.0 <= tolerance < 1e9:
            raise ValueError(f"a tolerance is at least a tick, not {tolerance}")
        self._tolerance = tolerance
        self._state = ffi.new("trochia_fit_state *", {"now": now * 256})

    @property
    def now(self) -> float:
        """Where the executor stands after what was fitted [ticks]."""
        return self._state.now / 256

    @property
    def worst(self) -> float:
        """The greatest deviation so far [ticks]."""
        return float(self._state.worst)

    def fit(self, ticks: NDArray[np.int64], *, backwards: bool = False) -> NDArray[np.void]:
        """Return the segments of steps in one direction (segments,), of dtype ``SEGMENT``.

        Parameters
        ----------
        ticks
            When each step is (steps,), after all before; gaps are at least 4 ticks.

        Raises
        ------
        ValueError
            For ticks that are too close, or before the executor's time.
        """
        given = np.ascontiguousarray(ticks, np.int64)
        if given.size and (given[0] < self.now + 1 or np.diff(given).min(initial=4) < 4):
            raise ValueError("steps come one after the other, at least 4 ticks apart, after those before")
        self._state.done, self._state.flags = 0, BACKWARDS if backwards else 0
        parts: list[NDArray[np.void]] = []
        while self._state.done < given.size:
            part = np.empty(_CHUNK, SEGMENT)
            made = lib.trochia_fit(
                pointer(given, "const int64_t *"), given.size, self._tolerance, self._state, _CHUNK,
                pointer(part, "trochia_tick_segment *"),
            )  # fmt: skip
            parts.append(part[:made])
        return np.concatenate(parts) if parts else np.empty(0, SEGMENT)
