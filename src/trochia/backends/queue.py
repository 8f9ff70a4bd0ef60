"""What a live backend holds: segments by stream time, and how much of a stop they have in hand.

In: segments, from a stream time on.  Out: where the joints are at a stream time, and whether the rate can still be
brought to 0 inside what is held.  Legend: r rate, u stream time; a row lets r change by its slew: d(r²/2)/du = -slew.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.backends.segments import SAME_TIME, Segments, joined, nothing
from trochia.errors import LocalProtocolError

if TYPE_CHECKING:
    from numpy.typing import NDArray

JOINS = 1e-6  #: greatest step between what is held and what is added [mm or degree]
AT_REST = 1e-9  #: of a velocity that is as good as none [mm/s or degree/s]


class Sample(NamedTuple):
    """State at stream times: row (times,), position and velocity (times, joints)."""

    row: NDArray[np.intp]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]


class Queue:
    """Segments from stream time ``start`` on; before and after them the joints stand still.

    Parameters
    ----------
    position
        Where the joints are (joints,) [mm or degree].
    """

    def __init__(self, position: NDArray[np.float64]) -> None:
        self.start = 0.0
        self.rest = position.copy()  # where the joints are with nothing held
        self.held = nothing(len(position))
        self.ends_at_rest = True  # whether the joints are at rest where it runs out
        self.end = 0.0  # stream time at which it runs out [s]
        self._starts = np.zeros(0)  # of each row, stream time
        self._stops = np.zeros(1)

    @property
    def starts(self) -> NDArray[np.float64]:
        """Stream time at which each row begins (rows,) [s]."""
        return self._starts

    def _hold(self, held: Segments) -> None:
        """Hold these rows from ``start`` on."""
        self.held = held
        ends = self.start + np.cumsum(held.duration)
        self.end = float(ends[-1]) if len(held) else self.start
        self._starts = np.concatenate([[self.start], ends[:-1]]) if len(held) else ends
        self._stops = np.concatenate([np.cumsum((held.slew * held.duration)[::-1])[::-1], [0.0]])
        self.ends_at_rest = not len(held) or bool(np.all(np.abs(held.end_velocity) <= AT_REST))

    def add(self, segments: Segments, at: float, executed: float) -> None:
        """Hold segments from stream time ``at`` on, instead of what was held from there.

        Raises
        ------
        LocalProtocolError
            When ``at`` is past or beyond the end, or the segments do not begin where what is held before them ends.
        """
        if at < executed - SAME_TIME or at > max(self.end, executed) + SAME_TIME:
            raise LocalProtocolError(f"segments from {at:.6f} s, but {executed:.6f} s to {self.end:.6f} s are held")
        if not len(segments):
            raise LocalProtocolError("no segments")
        kept = self.held.until(at - self.start) if len(self.held) and at > self.start + SAME_TIME else None
        before = self.rest if kept is None else kept.end
        gap = np.abs(segments.start - before)
        if not np.all(gap <= JOINS):
            joint = int(np.argmax(gap))
            raise LocalProtocolError(f"joint {joint} would jump by {gap[joint]:.6f} at stream time {at:.6f} s")
        if kept is None:
            self.start = at
        self._hold(segments if kept is None else joined([kept, segments]))

    def clear(self, position: NDArray[np.float64], executed: float) -> None:
        """Hold nothing, with the joints at ``position``."""
        self.rest = position.copy()
        self.start = executed
        self._hold(nothing(len(position)))

    def forget(self, executed: float) -> None:
        """Drop rows that have been run through."""
        if executed >= self.end - SAME_TIME:
            done = len(self.held)
        else:
            done = int(self._starts.searchsorted(executed - SAME_TIME, side="right")) - 1
        if done <= 0:
            return
        self.rest = self.held.rows(slice(0, done)).end
        self.start = self.end if done == len(self.held) else float(self._starts[done])
        self._hold(self.held.rows(slice(done, None)))

    def at(self, times: NDArray[np.float64]) -> Sample:
        """Return the state at stream times, none before the first row."""
        if not len(self.held):
            rows = np.zeros(len(times), np.intp)
            return Sample(rows, np.tile(self.rest, (len(times), 1)), np.zeros((len(times), len(self.rest))))
        row, position, velocity = self.held.at_rows(self._starts, times)
        velocity[times >= self.end - SAME_TIME] = 0.0
        return Sample(row, position, velocity)

    def stop_in_hand(self, u: float) -> float:
        """Return the greatest rate that can be brought to 0 between stream time ``u`` and the end."""
        if self.ends_at_rest:
            return math.inf
        row = max(int(self._starts.searchsorted(u, side="right")) - 1, 0)
        left = float(self._starts[row] + self.held.duration[row]) - u
        return math.sqrt(2.0 * (float(self._stops[row + 1]) + float(self.held.slew[row]) * max(left, 0.0)))

    def slew(self, u: float) -> float:
        """Return the slew of the row under way at stream time ``u`` [1/s]."""
        return float(self.held.slew[max(int(self._starts.searchsorted(u, side="right")) - 1, 0)])
