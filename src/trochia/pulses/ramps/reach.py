"""How long and how far to a speed, and from it to rest (S1-F35).

In: a profile and a speed.  Out: :class:`Reach`, in closed form where the law has one, else from its steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.pulses.ramps.exact import Even
from trochia.pulses.ramps.torque import legs

if TYPE_CHECKING:
    from trochia.pulses.ramps.profile import Profile

_HAIR = 1.0 - 1e-9  # of a speed: reached


@dataclass(frozen=True, slots=True, kw_only=True)
class Reach:
    """Time [s] and way [steps] from rest to a speed, and from it back to rest."""

    up_time: float
    up_steps: float
    down_time: float
    down_steps: float


def reach(made: Profile, speed: float) -> Reach | None:
    """Return how a profile reaches a speed [steps/s]; None where it does not."""
    fast = np.flatnonzero(made.speeds >= speed * _HAIR)
    if not fast.size:
        return None
    if made.law == "torque":
        up, down = legs(made.demand)
    elif made.law in {"exact", "linear"}:
        up, down = Even(made.demand.rising), Even(made.demand.falling)
    else:
        first, last = int(fast[0]), int(fast[-1])
        down_steps = made.delays.size - 1 - last
        return Reach(up_time=float(made.delays[:first].sum()), up_steps=first,
                     down_time=float(made.delays[last + 1 :].sum()), down_steps=down_steps)  # fmt: skip
    return Reach(up_time=up.duration(speed), up_steps=up.length(speed), down_time=down.duration(speed),
                 down_steps=down.length(speed))  # fmt: skip
