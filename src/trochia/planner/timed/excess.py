"""Which limits a motion given by time exceeds: it keeps its times, so that is told, not changed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from trochia.planner.limits import Limits
    from trochia.planner.timed.pieces import Pieces

_ROUNDING = 1e-9
KINDS = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True, kw_only=True)
class Excess:
    """One limit that is exceeded.

    Attributes
    ----------
    limit, kind
        Of what (``axis X``) and which (``velocity`` …).
    value, allowed
        The greatest there is, and the limit.
    time, move
        Begin of the piece where it is greatest [s], and its move.
    """

    limit: str
    kind: str
    value: float
    allowed: float
    time: float
    move: int

    def __str__(self) -> str:
        """Return it as a person reads it."""
        return f"{self.limit} {self.kind} {self.value:.6g} of {self.allowed:.6g} at {self.time:.3f} s"


def excesses(pieces: Pieces, limits: Limits) -> list[Excess]:
    """Return every limit of axes and joints that is exceeded, where it is exceeded most, in the order of the limits.

    The extremes are those of the cubics, exactly.  Jerk counts inside the pieces.
    """
    peaks, starts = pieces.peaks(limits.matrix), pieces.starts
    found: list[Excess] = []
    for row, name in enumerate(limits.names):
        for kind, values in zip(KINDS, peaks[:, :, row], strict=True):
            allowed, at = float(getattr(limits, kind)[row]), int(np.argmax(values))
            if values[at] > allowed * (1.0 + _ROUNDING):
                found.append(Excess(limit=name, kind=kind, value=float(values[at]), allowed=allowed,
                                    time=float(starts[at]), move=int(pieces.moves[at])))  # fmt: skip
    return found
