"""What time it is for a trajectory.  In: changes of its rate.  Out: u(t), the trajectory's own time, and motion over t.

Legend: t time, or turns of a spindle; u a trajectory's own time; r = du/dt its rate, 1 as planned; r', r'' its
derivatives (slew, twist).  Of a position q(u): velocity q' r, acceleration q'' r² + q' r', jerk q''' r³ + 3 q'' r r' +
q' r''.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from trochia.planner.ramp import ramp

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Planned(Protocol):
    """What is asked of a trajectory; ``u`` (k,) is its own time."""

    def position(self, u: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return positions (k, n)."""
        ...

    def velocity(self, u: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return first derivatives (k, n)."""
        ...

    def acceleration(self, u: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return second derivatives (k, n)."""
        ...

    def jerk(self, u: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Return third derivatives (k, n)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeBase:
    """u over t in pieces of constant u''', u, u' and u'' without a jump; before and after it goes on at an even rate.

    Attributes
    ----------
    t
        Where pieces begin (k,), rising; the last piece has no end and no slew.
    u, rate, slew, twist
        u and its derivatives there (k,); ``twist`` all along the piece.

    Raises
    ------
    ValueError
        When the arrays do not belong together, or u would run backwards at a piece's beginning.
    """

    t: NDArray[np.float64]
    u: NDArray[np.float64]
    rate: NDArray[np.float64]
    slew: NDArray[np.float64]
    twist: NDArray[np.float64]

    def __post_init__(self) -> None:
        columns = (self.t, self.u, self.rate, self.slew, self.twist)
        if not len(self.t) or any(column.shape != self.t.shape for column in columns):
            raise ValueError("a time base has a beginning, and as many of every number")
        if (np.diff(self.t) <= 0.0).any() or (self.rate < 0.0).any() or self.slew[-1] or self.twist[-1]:
            raise ValueError("a time base goes forwards, and ends at an even rate")
        for column in columns:
            column.setflags(write=False)

    @classmethod
    def even(cls, rate: float = 1.0, *, t: float = 0.0, u: float = 0.0) -> TimeBase:
        """Return the time base of one rate, with u at t."""
        return cls.of([(t, u, rate, 0.0, 0.0)])

    @classmethod
    def of(cls, rows: list[tuple[float, float, float, float, float]]) -> TimeBase:
        """Return the time base of rows of t, u, rate, slew and twist."""
        return cls(**dict(zip(("t", "u", "rate", "slew", "twist"), np.array(rows, dtype=np.float64).T.copy(),
                              strict=True)))  # fmt: skip

    def at(self, t: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """Return u (order 0) or its first to third derivative at each t (k,)."""
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        k = np.searchsorted(self.t, times, side="right") - 1
        before, k = k < 0, np.maximum(k, 0)
        tau, slew, twist = times - self.t[k], np.where(before, 0.0, self.slew[k]), np.where(before, 0.0, self.twist[k])
        if order == 0:
            return self.u[k] + tau * (self.rate[k] + tau * (slew / 2 + tau * twist / 6))
        if order == 1:
            return self.rate[k] + tau * (slew + tau * twist / 2)
        return slew + tau * twist if order == 2 else twist

    def slewed(self, t: float, rate: float, *, slew: float, twist: float = np.inf) -> TimeBase:
        """Return the time base that goes over to another rate from ``t`` on, as quickly as the bounds allow.

        Parameters
        ----------
        t
            At an instant at which the rate is even; what was to come after it is dropped.
        slew, twist
            Greatest |u''| and |u'''|; without ``twist`` u'' jumps (as PMAC's time base does).

        Raises
        ------
        ValueError
            Where the rate is not even, or the new one below zero.
        """
        (u,), (now,), (bend,) = (self.at(t, order) for order in range(3))
        if bend or rate < 0.0:
            raise ValueError("a rate is changed while it is even, and to one not below zero")
        rows = [tuple(row) for row in np.column_stack([self.t, self.u, self.rate, self.slew, self.twist]) if row[0] < t]
        for piece in ramp((float(now), 0.0), (rate, 0.0), slew, twist) if rate != now else ():
            rows.append((t, float(u), piece.v, piece.a, piece.j))
            t, u = t + piece.duration, u + piece.way
        return TimeBase.of([*rows, (t, float(u), rate, 0.0, 0.0)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Timed:
    """A trajectory on a time base: motion over t."""

    trajectory: Planned
    base: TimeBase

    def position(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' positions at each t (k, n)."""
        return self.trajectory.position(self.base.at(t))

    def velocity(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' velocities at each t (k, n)."""
        return self.trajectory.velocity(self.base.at(t)) * self.base.at(t, 1)[:, None]

    def acceleration(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' accelerations at each t (k, n)."""
        u, r, slew = (self.base.at(t, order)[:, None] for order in range(3))
        own = self.trajectory
        return own.acceleration(u[:, 0]) * r**2 + own.velocity(u[:, 0]) * slew

    def jerk(self, t: ArrayLike) -> NDArray[np.float64]:
        """Return the axes' jerks at each t, inside the pieces (k, n)."""
        u, r, slew, twist = (self.base.at(t, order)[:, None] for order in range(4))
        first, second, third = (
            of(u[:, 0]) for of in (self.trajectory.velocity, self.trajectory.acceleration, self.trajectory.jerk)
        )
        return third * r**3 + 3.0 * second * r * slew + first * twist
