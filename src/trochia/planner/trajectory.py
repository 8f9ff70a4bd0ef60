"""Motion over time.  In: a path and the schedule of speed along it.  Out: position and its derivatives at any time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import LimitError
from trochia.kernels import path as kernel
from trochia.kernels.layout import PHASE
from trochia.planner.binding import Binding, bind

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from trochia.planner.limits import Limits
    from trochia.planner.schedule import Schedule
    from trochia.planner.shaping import Shaping
    from trochia.program import Program
    from trochia.toolpath import Toolpath

BLOCK = 65536  #: phases a block: 3.7 MB


@dataclass(frozen=True, slots=True, kw_only=True)
class Trajectory:
    """Motion of one program on one machine, without a gap from t = 0 to ``duration``.

    Attributes
    ----------
    program, path, limits
        What was planned.
    profile
        Name of the velocity profile.
    schedule
        Speed along the path; None when nothing moves.
    times
        Total time by cause: ``motion``, ``dwell``, ``spindle``, ``tool`` [s]; they sum to ``duration``.
    duration
        Whole time [s].
    shaping
        What every axis passes through after planning; None: nothing.  It makes motion end later, by its delay, and the
        path rounder; line and power are those of its mean instant.
    """

    program: Program
    path: Toolpath
    limits: Limits
    profile: str
    schedule: Schedule | None
    times: dict[str, float]
    duration: float
    shaping: Shaping | None = None

    def blocks(self, size: int = BLOCK) -> Iterator[NDArray[Any]]:
        """Yield all phases in order, at most ``size`` (4 or more) a block (PHASE,).

        A path without motion has one phase if it has time, a rest, whose segment is not there.

        Raises
        ------
        LimitError
            When motion is shaped: then it is not along the path any more (:meth:`planned_blocks` gives what is shaped).
        """
        if self.shaping is not None:
            raise LimitError(
                "a shaped motion has no phases along its path",
                hint="Take the shaper out of the machine file's resonance, or use positions over time.",
            )
        return self.planned_blocks(size)

    def planned_blocks(self, size: int = BLOCK) -> Iterator[NDArray[Any]]:
        """Yield all phases in order as they were planned, before any shaping (PHASE,)."""
        if self.schedule is not None:
            yield from self.schedule.phases(size)
        elif self.duration > 0.0:
            rest = np.zeros(1, dtype=PHASE)
            rest["duration"], rest["flags"] = self.duration, 1
            yield rest

    def states(self, times: ArrayLike) -> NDArray[Any]:
        """Return segment, s, v, a, j and flags at each time [s], clamped to the ends (times,) of PHASE.

        Of a shaped motion they are those planned for the mean instant.
        """
        return self._planned_states(np.asarray(times, dtype=np.float64) - (self.shaping.mean if self.shaping else 0.0))

    def _planned_states(self, times: ArrayLike) -> NDArray[Any]:
        at = np.atleast_1d(np.asarray(times, dtype=np.float64))
        if self.schedule is not None:
            return self.schedule.states(at)
        rest = np.zeros(len(at), dtype=PHASE)
        rest["t"], rest["flags"] = at, 1
        return rest

    def _derivative(self, times: ArrayLike, order: int) -> NDArray[np.float64]:
        if self.schedule is None:
            still = self.path.start if order == 0 else np.zeros(len(self.path.axes))
            return np.tile(still, (len(np.atleast_1d(np.asarray(times))), 1))
        at = np.atleast_1d(np.asarray(times, dtype=np.float64))
        if self.shaping is None:
            return self._planned(at, order)
        end = self.duration - self.shaping.delay

        def planned(when: NDArray[np.float64]) -> NDArray[np.float64]:
            values = self._planned(when, order)
            if order:
                values[(when < 0.0) | (when > end)] = 0.0
            return values

        return self.shaping.apply(planned, at)

    def _planned(self, times: NDArray[np.float64], order: int) -> NDArray[np.float64]:
        states = self._planned_states(times)
        return kernel.sample(self.path.segments, self.path.pool, len(self.path.axes), states, order)

    def position(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' positions at each time (times, n) [mm, degree]."""
        return self._derivative(times, 0)

    def velocity(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' velocities at each time (times, n) [mm/s, degree/s]."""
        return self._derivative(times, 1)

    def acceleration(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' accelerations at each time (times, n) [mm/s², degree/s²]."""
        return self._derivative(times, 2)

    def jerk(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' jerks inside the phases at each time (times, n) [mm/s³, degree/s³]."""
        return self._derivative(times, 3)

    def path_speed(self, times: ArrayLike) -> NDArray[np.float64]:
        """Return ds/dt at each time (times,) [mm/s; degree/s where only rotary axes move]."""
        return self.states(times)["v"]

    def binding(self, times: ArrayLike) -> Binding:
        """Return which limit binds at each time (times,): its kind, its axis or joint, and how much of it is used."""
        return self.binding_of(self.states(times))

    def binding_of(self, states: NDArray[Any]) -> Binding:
        """Return which limit binds in each state (PHASE rows)."""
        if self.schedule is None:
            return Binding.of_rest(len(states), self.limits.names)
        return bind(self.path, self.limits, states, jerk=self.schedule.jerk_limited, curves=self.schedule.by_curves)

    def line_at(self, times: ArrayLike) -> NDArray[np.uint32]:
        """Return the source line whose move is under way at each time (times,); 0 where nothing ever moves."""
        if self.schedule is None:
            return np.zeros(len(np.atleast_1d(np.asarray(times))), dtype=np.uint32)
        moves = self.path.segments["move"][self.states(times)["segment"]]
        return self.program.moves["line"][moves]

    def power_at(self, times: ArrayLike) -> NDArray[np.float32]:
        """Return the beam's power or the spindle's S at each time (times,), 0 off.

        It is that of the move under way; at rest, that with which the next move begins, 0 after the last.
        """
        if self.schedule is None:
            return np.zeros(len(np.atleast_1d(np.asarray(times))), dtype=np.float32)
        states = self.states(times)
        segments = np.append(self.program.moves["power"][self.path.segments["move"]], np.float32(0.0))
        waiting = (states["flags"] & 1 == 1) & (states["s"] > 0.0)
        return segments[states["segment"] + waiting]

    @property
    def move_times(self) -> NDArray[np.float64]:
        """Time in motion of each of the program's moves (moves,) [s]; a blend counts to the move it enters."""
        count = len(self.program.moves)
        return np.zeros(count) if self.schedule is None else self.schedule.move_times(count)

    @property
    def peaks(self) -> dict[str, dict[str, float | None]]:
        """Greatest |velocity|, |acceleration| and |jerk| of each axis; jerk None where the profile lets it be.

        Of a shaped motion they are those planned, which it does not exceed.
        """
        rows = {} if self.schedule is None else self.schedule.peaks()
        jerk = 0.0 if self.schedule is None else None
        none: dict[str, float | None] = {"velocity": 0.0, "acceleration": 0.0, "jerk": jerk}
        return {
            letter: none | {kind: float(values[column]) for kind, values in rows.items()}
            for column, letter in enumerate(self.path.axes)
        }

    @property
    def slowed(self) -> NDArray[np.intp]:
        """Rows of the program's moves whose feed a limit on velocity keeps from being reached, rising.

        The drive's least time of a segment is such a limit too.
        """
        if self.schedule is None:
            return np.zeros(0, dtype=np.intp)
        segments, over = self.path.segments, self.schedule.over_limit()
        if self.limits.segment_time > 0.0:
            feed = segments["speed_limit"]
            over = over | (np.isfinite(feed) & (segments["length"] < feed * self.limits.segment_time))
        return np.unique(segments["move"][over]).astype(np.intp)
