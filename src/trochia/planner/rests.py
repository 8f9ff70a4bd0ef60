"""Times at rest.  In: a program's actions, the machine, the path.  Out: how long, why, before which segment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.program import Dwell, End, Spindle, ToolChange

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.io import Spindle as SpindleData
    from trochia.machine.machine import Machine
    from trochia.program import Program
    from trochia.toolpath import Toolpath


@dataclass(frozen=True, slots=True, kw_only=True)
class Rests:
    """Stretches of rest, in order.

    Attributes
    ----------
    segments
        Row of the path's segment each stands before (k,); the number of segments: after the last.
    seconds
        How long each is (k,) [s].
    times
        Sums by cause: ``dwell``, ``spindle``, ``tool`` [s].
    """

    segments: NDArray[np.uint64]
    seconds: NDArray[np.float64]
    times: dict[str, float]


def rests_of(program: Program, machine: Machine, path: Toolpath) -> Rests:
    """Return the rests of a program: dwells, the spindle's changes of speed, tool changes."""
    found: list[tuple[int, str, float]] = []
    speed = 0.0
    for action in program.actions:
        if isinstance(action, Dwell):
            found.append((action.at, "dwell", action.seconds))
        elif isinstance(action, ToolChange):
            found.append((action.at, "tool", machine.tool_change_time))
        elif isinstance(action, Spindle):
            if speed and 0 < action.at <= len(program.moves):  # S may have changed while it turned
                speed = math.copysign(float(program.moves["power"][action.at - 1]), speed)
            asked = action.direction * action.speed
            found.append((action.at, "spindle", _spin_up(machine.spindle, speed, asked)))
            speed = asked
        elif isinstance(action, End):
            found.append((action.at, "spindle", _spin_up(machine.spindle, speed, 0.0)))
            speed = 0.0
    kept = [rest for rest in found if rest[2] > 0.0]
    times = {cause: sum(s for _, c, s in kept if c == cause) for cause in ("dwell", "spindle", "tool")}
    moves = np.array([at for at, _, _ in kept], dtype=np.uint32)
    return Rests(
        segments=np.searchsorted(path.segments["move"], moves, side="left").astype(np.uint64),
        seconds=np.array([seconds for *_, seconds in kept], dtype=np.float64),
        times=times,
    )


def _spin_up(spindle: SpindleData | None, before: float, after: float) -> float:
    """Return the time from one signed speed to another [s]: in proportion to the change, full speed in spin_up."""
    if spindle is None:
        return 0.0
    bounded = [min(max(speed, -spindle.maximum), spindle.maximum) for speed in (before, after)]
    return abs(bounded[1] - bounded[0]) / spindle.maximum * spindle.spin_up
