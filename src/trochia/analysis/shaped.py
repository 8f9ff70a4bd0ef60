"""How far input shaping takes motion off its path.  In: a shaped trajectory.  Out: how far, in which line, a warning.

Distance is taken both ways: of the shaped motion from the planned path, and of the planned path (its corners above all)
from the shaped one.  It is seen at every servo period, with a cubic between.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.problems import Problem, Severity
from trochia.kernels.contour import contour_distance

if TYPE_CHECKING:
    from trochia.machine.machine import Machine
    from trochia.planner import Trajectory

_CHUNK = 65_536  #: instants looked at in one go
_MARGIN = 4096  #: instants of path on either side of them
_WORTH = 0.0005  #: what shaping takes off the path is told from here on [mm]


@dataclass(frozen=True, slots=True, kw_only=True)
class Deviation:
    """Greatest distance between planned path and shaped motion [mm], and the source line in which it is."""

    peak: float
    line: int


def deviation(trajectory: Trajectory, period: float) -> Deviation | None:
    """Return how far shaping takes the linear axes off their path, or None where nothing is shaped.

    Parameters
    ----------
    period
        Time between the instants looked at [s].
    """
    shaping, linear = trajectory.shaping, trajectory.limits.linear
    if shaping is None:
        return None
    planned = dataclasses.replace(trajectory, shaping=None, duration=trajectory.duration - shaping.delay)
    count = int(np.ceil(trajectory.duration / period)) + 1
    worst = Deviation(peak=0.0, line=0)
    for first in range(0, count, _CHUNK) if linear else ():
        seen = np.arange(max(first - _MARGIN, 0), min(first + _CHUNK + _MARGIN, count))
        times = seen * period
        path = planned.position(times - shaping.mean)[:, :linear]
        motion = trajectory.position(times)[:, :linear]
        away = np.maximum(contour_distance(path, motion), contour_distance(motion, path))
        away[(seen < first) | (seen >= first + _CHUNK)] = 0.0
        at = int(np.argmax(away))
        if away[at] > worst.peak:
            worst = Deviation(peak=float(away[at]), line=int(trajectory.line_at(times[at])[0]))
    return worst


def warning(found: Deviation | None, machine: Machine, file: str) -> list[Problem]:
    """Return the warning that shaping takes motion off its path, if it does."""
    if found is None or found.peak < _WORTH:
        return []
    return [
        Problem(
            severity=Severity.WARNING, code="shaping-deviation", file=file, line=found.line,
            message=f"input shaping ({words(machine)}) takes motion up to {found.peak:.3f} mm off its path",
            hint="Slow down in corners (a lower feed, jerk or acceleration), or take a shorter shaper.",
        )
    ]  # fmt: skip


def words(machine: Machine) -> str:
    """Return a machine's shapers, like ``X zv 45 Hz, Y ei 38 Hz``."""
    return ", ".join(f"{axis.name} {axis.resonance.shaper} {axis.resonance.frequency:g} Hz"
                     for axis in machine.axes if axis.resonance is not None and axis.resonance.shaper)  # fmt: skip
