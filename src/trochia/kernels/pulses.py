"""Step pulses that a motor has yet to be given.  In: instants and directions.  Out: the same, in order, for C."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulses:
    """Instants [s since zero], never falling, and directions 1 or -1, (pulses,) each."""

    times: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    signs: NDArray[np.int8] = field(default_factory=lambda: np.empty(0, np.int8))

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.times)

    def followed(self, times: NDArray[np.float64], directions: NDArray[np.int8], now: float) -> Pulses:
        """Return these and others behind them, instants (pulses,) with directions (pulses,).

        Raises
        ------
        LimitError
            When they do not rise from the last one here, or from ``now`` [s].
        """
        times, signs = np.asarray(times, np.float64), np.asarray(directions, np.int8)
        if times.ndim != 1 or times.shape != signs.shape or not (np.abs(signs) == 1).all():
            raise ValueError("expected instants (pulses,) with a direction of 1 or -1 for each")
        first = float(self.times[-1]) if len(self) else now
        if len(times) and not (first <= times[0] and times[-1] < np.inf and (np.diff(times) >= 0).all()):
            raise LimitError(f"step pulses must rise from {first:g} s on")
        return Pulses(times=np.concatenate([self.times, times]), signs=np.concatenate([self.signs, signs]))

    def behind(self, taken: int) -> Pulses:
        """Return those behind the first ``taken``."""
        return Pulses(times=self.times[taken:], signs=self.signs[taken:])
