"""How well a place is met again: the positions an axis came to rest at, by target and by the way it came.

In: a recording in which an axis rests at the same places more than once.  Out: mean and spread at each.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder import Recording


@dataclass(frozen=True, slots=True, kw_only=True)
class Visits:
    """The visits of one target from one side.

    Attributes
    ----------
    target, way
        Position commanded, and 1 where it was reached going up, -1 going down.
    errors
        Actual less commanded at the end of each rest (n,) [mm or degree].
    """

    target: float
    way: int
    errors: NDArray[np.float64]

    @property
    def mean(self) -> float:
        """Mean error."""
        return float(self.errors.mean())

    @property
    def spread(self) -> float:
        """Three standard deviations (of the sample, n - 1), to either side; 0 of a single visit."""
        return 3.0 * float(self.errors.std(ddof=1)) if len(self.errors) > 1 else 0.0


def repeatability(recording: Recording, axis: str, *, rest: float = 0.05) -> tuple[Visits, ...]:
    """Return the visits of every place where the axis' command rests for at least ``rest`` [s], lowest first."""
    told, was = (np.asarray(recording[f"{axis}.{name}"][:], np.float64) for name in ("commanded", "actual"))
    moved = np.flatnonzero(np.diff(told) != 0)
    edges = np.concatenate([[-1], moved, [len(told) - 1]])
    found: dict[tuple[float, int], list[float]] = {}
    for begin, end in pairwise(edges.tolist()):
        if (end - begin) * recording.period >= rest and begin >= 0:
            way = 1 if told[begin + 1] > told[begin] else -1
            found.setdefault((round(float(told[end]), 9), way), []).append(float(was[end] - told[end]))
    return tuple(
        Visits(target=target, way=way, errors=np.array(errors)) for (target, way), errors in sorted(found.items())
    )


def reversal(visits: tuple[Visits, ...]) -> dict[float, float]:
    """Return the reversal error of every target reached from both sides: mean going up less mean going down."""
    up = {entry.target: entry.mean for entry in visits if entry.way > 0}
    return {entry.target: up[entry.target] - entry.mean for entry in visits if entry.way < 0 and entry.target in up}
