"""Motion as cubics in time.  In: durations and coefficients.  Out: position and its derivatives, and their extremes.

Legend: a piece k lasts T_k and is x = c0 + c1 t + c2 t² + c3 t³, t from its own start.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

_FACTORS = np.array([[1.0, 1.0, 1.0, 1.0], [0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 2.0, 6.0], [0.0, 0.0, 0.0, 6.0]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Pieces:
    """Cubics in time, one after the other from t = 0.

    Attributes
    ----------
    durations
        Of each (k,) [s], above 0.
    coefficients
        c0 to c3 of each, by axis (k, 4, n) [mm, degree and their rates].
    moves
        To which of the moves given each belongs (k,), rising.
    """

    durations: Floats
    coefficients: Floats
    moves: NDArray[np.int64]

    def __post_init__(self) -> None:
        count = len(self.durations)
        if self.coefficients.ndim != 3 or self.coefficients.shape[:2] != (count, 4) or self.moves.shape != (count,):
            raise ValueError("pieces are durations (k,), coefficients (k, 4, n) and moves (k,)")
        if not (self.durations > 0.0).all():
            raise ValueError("a piece lasts longer than no time")

    @property
    def starts(self) -> Floats:
        """When each begins (k,) [s]."""
        return np.cumsum(self.durations) - self.durations

    @property
    def duration(self) -> float:
        """Of all [s]."""
        return float(self.durations.sum())

    def at(self, times: ArrayLike, derivative: int = 0) -> Floats:
        """Return position (0), velocity, acceleration or jerk (3) at each time [s], clamped to the ends (times, n)."""
        t = np.clip(np.atleast_1d(np.asarray(times, dtype=np.float64)), 0.0, self.duration)
        starts = self.starts
        row = np.clip(np.searchsorted(starts, t, side="right") - 1, 0, len(starts) - 1)
        tau = np.minimum(t - starts[row], self.durations[row])
        powers = np.stack([tau ** max(power - derivative, 0) for power in range(4)], axis=1) * _FACTORS[derivative]
        return np.einsum("tp,tpn->tn", powers, self.coefficients[row])

    def peaks(self, matrix: Floats) -> Floats:
        """Return the greatest |velocity|, |acceleration|, |jerk| of each row of C in each piece (3, k, rows), exactly.

        Velocity is a parabola: greatest at an end or where acceleration is 0; acceleration is a line.
        """
        c = np.einsum("kpn,rn->kpr", self.coefficients, matrix)
        span = self.durations[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.clip(np.nan_to_num(-c[:, 2] / (3.0 * c[:, 3]), nan=0.0), 0.0, span)
        velocity = [np.abs(c[:, 1] + t * (2.0 * c[:, 2] + 3.0 * t * c[:, 3])) for t in (0.0 * span, turn, span)]
        acceleration = [np.abs(2.0 * c[:, 2] + 6.0 * t * c[:, 3]) for t in (0.0 * span, span)]
        return np.stack([np.max(velocity, axis=0), np.max(acceleration, axis=0), np.abs(6.0 * c[:, 3])])


def rest(point: ArrayLike, seconds: float, move: int = 0) -> Pieces:
    """Return a rest at a point (n,)."""
    at = np.asarray(point, dtype=np.float64)
    coefficients = np.zeros((1, 4, len(at)))
    coefficients[0, 0] = at
    return Pieces(durations=np.array([seconds]), coefficients=coefficients, moves=np.array([move]))


def joined(parts: Sequence[Pieces]) -> Pieces:
    """Return parts one after the other; their moves must not fall.

    Raises
    ------
    LimitError
        When one does not begin where the one before ends.
    """
    for before, after in itertools.pairwise(parts):
        gap = np.abs(after.at(0.0) - before.at(before.duration)).max()
        if gap > 1e-9 * (1.0 + np.abs(after.at(0.0)).max()):
            raise LimitError(
                f"moves given by time leave a gap of {gap:g}", hint="Each begins where the one before ends."
            )
    return Pieces(
        durations=np.concatenate([part.durations for part in parts]),
        coefficients=np.concatenate([part.coefficients for part in parts]),
        moves=np.concatenate([part.moves for part in parts]),
    )


def hermite(points: Floats, velocities: Floats, durations: Floats, moves: NDArray[np.int64]) -> Pieces:
    """Return the cubics through points with velocities (k + 1, n) in times (k,), the only ones there are."""
    span, step = durations[:, None], np.diff(points, axis=0)
    v0, v1 = velocities[:-1], velocities[1:]
    c2 = (3.0 * step - (2.0 * v0 + v1) * span) / span**2
    c3 = ((v0 + v1) * span - 2.0 * step) / span**3
    return Pieces(durations=durations, coefficients=np.stack([points[:-1], v0, c2, c3], axis=1), moves=moves)
