"""LINEAR by time: moves of time TM with ramps of time TA, whose ends are rounded for TS, blended into each other.

In: points, TM, TA, TS of each move, what the motors can do.  Out: the ramps as they will be, and the motion.

Move i has the even velocity v_i = d_i / TM_i.  The change from v_(i-1) to v_i takes TA_i and lies evenly about the
instant at which the corner would be passed without it; so the corner is cut, by
|v_i - v_(i-1)| ((TA - TS) / 8 + TS² / 24 (TA - TS)), and every even stretch lies on its line.  The first and the last
ramp are changes from rest and to it: together moves take (TA of the first) / 2 + sum of TM + (TA of the last) / 2,
which is TM + TA for one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError
from trochia.planner.timed.pieces import Pieces

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

_LONGEST = 8388.607  #: time of a move [s]: 2^23 - 1 ms

_NONE = 1e-9  #: a rounding of less time is none [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramps:
    """Moves and the ramps between them, as they will be.

    Attributes
    ----------
    points
        Start and ends (m + 1, n).
    times
        Of the moves (m,) [s]: TM, stretched where it is less than TA or a velocity asks for it.
    ramps, rounds
        Of the changes of velocity, that from rest and that to rest included (m + 1,) [s]: TA, at least 2 TS and
        stretched where an acceleration asks for it, and TS.
    """

    points: Floats
    times: Floats
    ramps: Floats
    rounds: Floats

    @property
    def velocities(self) -> Floats:
        """Even velocity of each move (m, n)."""
        return np.diff(self.points, axis=0) / self.times[:, None]

    @property
    def changes(self) -> Floats:
        """Change of velocity in each ramp (m + 1, n)."""
        still = np.zeros((1, self.points.shape[1]))
        return np.diff(np.vstack([still, self.velocities, still]), axis=0)

    @property
    def accelerations(self) -> Floats:
        """Greatest |acceleration| in each ramp, |change| / (TA - TS) (m + 1, n)."""
        return np.abs(self.changes) / (self.ramps - self.rounds)[:, None]


def ramps(
    start: ArrayLike,
    ends: ArrayLike,
    *,
    tm: ArrayLike,
    ta: ArrayLike,
    ts: ArrayLike = 0.0,
    velocity: ArrayLike = np.inf,
    acceleration: ArrayLike = np.inf,
) -> Ramps:
    """Return moves from ``start`` (n,) to each end (m, n) with their ramps.

    Parameters
    ----------
    tm, ta, ts
        TM, TA, TS of each move (m,) or of all [s].
    velocity, acceleration
        Greatest of each axis (n,).  Where a move is faster its TM is stretched, as if it were slower; where a change is
        greater its TA is, up to TM.  A ramp never reaches into the one before, TA_(i+1) <= 2 (TM_i - TA_i / 2): there
        it is cut, and what is left above the acceleration is not taken away (:func:`excesses` tells it).

    Raises
    ------
    LimitError
        When a time is below 0, TA and TS are both 0, or a move takes longer than 2^23 - 1 ms.
    """
    points = np.vstack([np.atleast_1d(np.asarray(start, np.float64)), np.asarray(ends, np.float64)])
    count = len(points) - 1
    times, ramp, rounds = (np.array(np.broadcast_to(np.asarray(t, np.float64), count)) for t in (tm, ta, ts))
    if (times < 0.0).any() or (ramp < 0.0).any() or (rounds < 0.0).any():
        raise LimitError("TM, TA and TS are times, zero or more")
    rounds[rounds < _NONE] = 0.0
    ramp = np.maximum(ramp, 2.0 * rounds)
    if not (ramp > 0.0).all():
        raise LimitError("TA and TS are both 0: velocity would jump", hint="Give TA, like TA 100.")
    slowest = np.max(np.abs(np.diff(points, axis=0)) / velocity, axis=1)
    times = np.maximum.reduce([times, ramp, slowest])
    if (times > _LONGEST).any():
        raise LimitError(f"a move takes at most {_LONGEST:g} s")
    made = Ramps(points=points, times=times, ramps=np.append(ramp, ramp[-1]), rounds=np.append(rounds, rounds[-1]))
    asked = np.max(np.abs(made.changes) / acceleration, axis=1) + made.rounds
    taken = np.minimum(np.maximum(made.ramps, asked), np.append(times, np.inf))
    for i in range(count):
        taken[i + 1] = min(taken[i + 1], 2.0 * (times[i] - taken[i] / 2.0))
    return Ramps(points=points, times=times, ramps=taken, rounds=np.minimum(made.rounds, taken / 2.0))


def blended(moves: Ramps) -> Pieces:
    """Return the motion: cubics in time, three a ramp and one an even stretch.

    Raises
    ------
    LimitError
        When ramps overlap: a TA is greater than what the ramp before leaves of the move.
    """
    durations: list[float] = []
    coefficients: list[Floats] = []
    owners: list[int] = []
    velocities = np.vstack([np.zeros(moves.points.shape[1]), moves.velocities])
    changes, last = moves.changes, len(moves.times) - 1

    def add(
        seconds: float, x: Floats, rates: tuple[Floats, Floats, Floats], move: int
    ) -> tuple[Floats, Floats, Floats]:
        v, a, j = rates
        if not seconds > 0.0:
            return x, v, a
        durations.append(seconds)
        coefficients.append(np.stack([x, v, a / 2.0, j / 6.0]))
        owners.append(move)
        t = seconds
        return x + t * (v + t * (a / 2.0 + t * j / 6.0)), v + t * (a + t * j / 2.0), a + t * j

    for i, (ramp, round_) in enumerate(zip(moves.ramps.tolist(), moves.rounds.tolist(), strict=True)):
        move, none = min(i, last), np.zeros(moves.points.shape[1])
        x, v = moves.points[i] - velocities[i] * ramp / 2.0, velocities[i]
        if round_ > 0.0:
            jerk = changes[i] / ((ramp - round_) * round_)
            x, v, a = add(round_, x, (v, none, jerk), move)
            x, v, a = add(ramp - 2.0 * round_, x, (v, a, none), move)
            x, v, _ = add(round_, x, (v, a, -jerk), move)
        else:
            x, v, _ = add(ramp, x, (v, changes[i] / ramp, none), move)
        if i <= last:
            even = moves.times[i] - ramp / 2.0 - float(moves.ramps[i + 1]) / 2.0
            if even < -1e-12 * moves.times[i]:
                most = 2e3 * (float(moves.times[i]) - ramp / 2.0)
                raise LimitError(f"the ramps of move {i + 1} overlap: TA of the next is at most {most:g} ms")
            if even > 1e-12 * moves.times[i]:
                add(even, moves.points[i] + velocities[i + 1] * ramp / 2.0, (velocities[i + 1], none, none), move)
    return Pieces(durations=np.array(durations), coefficients=np.array(coefficients), moves=np.array(owners))
