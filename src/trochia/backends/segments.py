"""Motion as a live backend is given it: cubics of every joint over short times.

In: a motion and times to cut it at.  Out: :class:`Segments`, rows that follow each other without a gap.  A cubic that
keeps position and velocity at both ends of h seconds is within h⁴/384 of the greatest fourth derivative, and exact on
lines between the instants where jerk changes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

SAME_TIME = 1e-9  #: how far times that are the same may be apart [s]
_POWERS = np.arange(4)


class Planned(Protocol):
    """What segments are made of: a trajectory, or anything like it; ``t`` is (samples,) [s]."""

    def position(self, t: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return positions of the axes (samples, axes) [mm or degree]."""
        ...

    def velocity(self, t: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return velocities of the axes (samples, axes) [mm/s or degree/s]."""
        ...

    def line_at(self, t: NDArray[np.float64], /) -> NDArray[Any]:
        """Return the source line of the motion (samples,)."""
        ...

    def power_at(self, t: NDArray[np.float64], /) -> NDArray[Any]:
        """Return the power of the beam (samples,)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Segments:
    """A stretch of motion, in joint space.

    Attributes
    ----------
    duration
        Of each row (rows,) [s].
    joints
        Coefficients by the time since the row's start, rising powers (rows, joints, 4) [mm or degree].
    line
        Source line (rows,).
    power
        Of the beam, 0 off (rows,).
    slew
        How fast the backend may change the rate at which it runs through the row (rows,) [1/s].
    """

    duration: NDArray[np.float64]
    joints: NDArray[np.float64]
    line: NDArray[np.uint32]
    power: NDArray[np.float32]
    slew: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.duration)

    @property
    def span(self) -> float:
        """How long it takes [s]."""
        return float(self.duration.sum())

    @property
    def start(self) -> NDArray[np.float64]:
        """Where the joints are at its start (joints,)."""
        return self.joints[0, :, 0]

    @property
    def end(self) -> NDArray[np.float64]:
        """Where the joints are at its end (joints,)."""
        return self.joints[-1] @ self.duration[-1] ** _POWERS

    @property
    def end_velocity(self) -> NDArray[np.float64]:
        """How fast the joints are at its end (joints,) [mm/s or degree/s]."""
        tau = self.duration[-1]
        return self.joints[-1, :, 1:] @ np.array([1.0, 2.0 * tau, 3.0 * tau * tau])

    def rows(self, at: slice) -> Segments:
        """Return some of the rows."""
        return Segments(
            duration=self.duration[at], joints=self.joints[at], line=self.line[at], power=self.power[at],
            slew=self.slew[at],
        )  # fmt: skip

    def until(self, time: float) -> Segments:
        """Return what lies before a time after its start [s], the last row cut.

        A last row that ends earlier by rounding is stretched to end there: in an hour such differences would add up.
        """
        ends = np.cumsum(self.duration)
        if time > ends[-1] + SAME_TIME:
            return self
        count = min(int(np.searchsorted(ends, time, side="left")) + 1, len(self))
        cut = self.rows(slice(0, count))
        duration = cut.duration.copy()
        duration[-1] = time - (ends[count - 2] if count > 1 else 0.0)
        return Segments(duration=duration, joints=cut.joints, line=cut.line, power=cut.power, slew=cut.slew)

    def at(self, times: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
        """Return row (times,), position and velocity of the joints (times, joints) at times after its start [s]."""
        return self.at_rows(np.concatenate([[0.0], np.cumsum(self.duration)[:-1]]), times)

    def at_rows(
        self, starts: NDArray[np.float64], times: NDArray[np.float64]
    ) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
        """Return what :meth:`at` does, with the time at which each row begins (rows,) given."""
        row = np.maximum(starts.searchsorted(times, side="right") - 1, 0)
        tau = np.minimum(np.maximum(times - starts[row], 0.0), self.duration[row])[:, None]
        c = self.joints[row]
        position = c[..., 0] + tau * (c[..., 1] + tau * (c[..., 2] + tau * c[..., 3]))
        velocity = c[..., 1] + tau * (2.0 * c[..., 2] + tau * 3.0 * c[..., 3])
        return row, position, velocity


def nothing(joints: int) -> Segments:
    """Return no motion of so many joints."""
    return Segments(
        duration=np.zeros(0), joints=np.zeros((0, joints, 4)), line=np.zeros(0, np.uint32),
        power=np.zeros(0, np.float32), slew=np.zeros(0),
    )  # fmt: skip


def joined(parts: Sequence[Segments]) -> Segments:
    """Return one stretch after the other (at least one)."""
    return Segments(
        duration=np.concatenate([part.duration for part in parts]),
        joints=np.concatenate([part.joints for part in parts]),
        line=np.concatenate([part.line for part in parts]),
        power=np.concatenate([part.power for part in parts]),
        slew=np.concatenate([part.slew for part in parts]),
    )


def sampled(
    motion: Planned, matrix: NDArray[np.float64], times: NDArray[np.float64], slew: NDArray[np.float64]
) -> Segments:
    """Return a motion between times.

    Parameters
    ----------
    matrix
        Joint positions a unit of each axis (joints, axes).
    times
        Where to cut, rising strictly, at least two (rows + 1,) [s].
    slew
        Of each row (rows,) [1/s].
    """
    position, velocity = motion.position(times) @ matrix.T, motion.velocity(times) @ matrix.T
    h = np.diff(times)[:, None]
    middle = times[:-1] + 0.5 * h[:, 0]
    chord, rise = (position[1:] - position[:-1]) / h, velocity[1:] - velocity[:-1]
    bend = (3.0 * (chord - velocity[:-1]) - rise) / h
    twist = (rise - 2.0 * (chord - velocity[:-1])) / h**2
    return Segments(
        duration=h[:, 0],
        joints=np.stack([position[:-1], velocity[:-1], bend, twist], axis=-1),
        line=np.asarray(motion.line_at(middle), np.uint32),
        power=np.asarray(motion.power_at(middle), np.float32),
        slew=slew,
    )
