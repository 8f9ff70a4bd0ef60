"""The greatest speeds of a motor that loses no steps, searched on the twin as one searches them on a bench.

In: a motor behind its driver, its load, ways of timing.  Out: pull-out and start/stop speeds [rad/s].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.sweep.procedures import pull_out_speed, start_stop_speeds
from trochia.analysis.sweep.timing import TIMINGS
from trochia.machine.motors.excitation import excitation
from trochia.machine.motors.hybrid import FREE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from trochia.analysis.sweep.timing import Timing
    from trochia.machine.drivers import Fed
    from trochia.machine.motors.shaft import ShaftLoad

    Progress = Callable[[str, float], None] | None

FIRST = 50.0  #: where the sketches begin [rpm]; a motor that does not get to twice as much begins lower
FULL_STEPS = ("two-phase", "one-phase")
COMPARED = ("shield", "exact")
RPM = 30.0 / pi


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of one way of excitation with one timing.

    Attributes
    ----------
    excitation, timing
        Their names.
    pull_out, start_stop
        Speeds that were asked for [rad/s].
    pull_out_turned, start_stop_turned
        How fast the motor turned then on average [rad/s]: a step's own work makes it slower than asked.
    start_stop_first
        Before the first speed that costs a step in starting or stopping, resonance or not [rad/s].
    """

    excitation: str
    timing: str
    pull_out: float
    start_stop: float
    pull_out_turned: float
    start_stop_turned: float
    start_stop_first: float

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        names = ("pull_out", "start_stop", "pull_out_turned", "start_stop_turned", "start_stop_first")
        return {"excitation": self.excitation, "timing": self.timing} | {
            f"{name}_rpm": float(getattr(self, name)) * RPM for name in names
        }


def limits(
    made: Fed, load: ShaftLoad = FREE, timing: Timing = TIMINGS["exact"], *, top: float, progress: Progress = None
) -> Limits:
    """Return a motor's limits in steps of 1 rpm, from 50 rpm or a quarter of ``top`` to twice ``top`` [rad/s]."""
    begin = max(1.0, min(FIRST, round(top * RPM / 4)))
    speeds = (np.arange(begin, 2 * top * RPM) / RPM).tolist()
    name = f"{made.excitation.name}, {timing.name}"
    out = pull_out_speed(made, _told(speeds, f"{name}: pull-out", progress), load, timing)
    start, first = start_stop_speeds(made, _told(speeds, f"{name}: start/stop", progress), load, timing)
    steps = made.motor.full_steps * made.excitation.steps_per_full_step

    def turned(speed: float) -> float:
        return 2 * pi / float(timing.times(2 * pi / speed / steps, steps)[-1]) if speed else 0.0

    return Limits(excitation=made.excitation.name, timing=timing.name, pull_out=out, start_stop=start,
                  pull_out_turned=turned(out), start_stop_turned=turned(start),
                  start_stop_first=first)  # fmt: skip


def compare(made: Fed, load: ShaftLoad = FREE, *, top: float, progress: Progress = None) -> list[Limits]:
    """Return the limits in full steps, both phases on and one, timed as the shield's library does and exactly."""
    return [
        limits(replace(made, excitation=excitation(mode)), load, TIMINGS[timing], top=top, progress=progress)
        for mode in FULL_STEPS
        for timing in COMPARED
    ]


def _told(speeds: list[float], label: str, progress: Progress) -> Iterator[float]:
    """Yield speeds, telling how far one is; most searches end before the last."""
    for i, speed in enumerate(speeds):
        if progress is not None:
            progress(label, i / len(speeds))
        yield speed
