"""Reversal spikes of any motion: how an axis' error jumps when its command turns round.

In: a recording.  Out: one spike a turn: when, at which line, how far the error moves from where it stood before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from trochia.recorder import Recording

AFTER, BEFORE = 0.1, 0.02  #: a turn in which its spike is looked for, and before it, of which the mean is taken [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """A turn of one axis: when [s], the source line (None: not recorded), and the jump of its error there."""

    time: float
    line: int | None
    height: float


def turns(recording: Recording, axis: str) -> tuple[Turn, ...]:
    """Return the spike of every turn of the axis' command [mm or degree], in the order of time."""
    told, was = (np.asarray(recording[f"{axis}.{name}"][:], np.float64) for name in ("commanded", "actual"))
    steps, error = np.diff(told), was - told
    moving = np.flatnonzero(steps)
    changes = np.flatnonzero(np.sign(steps[moving[1:]]) != np.sign(steps[moving[:-1]]))
    before, after = (max(1, round(seconds / recording.period)) for seconds in (BEFORE, AFTER))
    lines = recording["path.line"] if "path.line" in recording else None  # noqa: SIM401 - a recording has no get
    found: list[Turn] = []
    for k in changes.tolist():
        last, at = int(moving[k]) + 1, int(moving[k + 1])  # the turn may rest in between
        stood = error[max(last - before, 0) : last + 1].mean()
        jump = error[at : at + after + 1] - stood
        found.append(Turn(time=recording.start + at * recording.period, line=None if lines is None else int(lines[at]),
                          height=float(jump[int(np.argmax(np.abs(jump)))])))  # fmt: skip
    return tuple(found)
