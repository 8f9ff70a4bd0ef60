"""A planned job and what it measures.

In: a program and a machine.  Out: a :class:`Plan`: path, trajectory, and the figures that `trochia plan` prints.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.shaped import deviation
from trochia.planner import PROFILES, Trajectory, path_of, profile_of
from trochia.planner import plan as plan_motion
from trochia.toolpath import Measure, Toolpath, build, measure_program

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.shaped import Deviation
    from trochia.machine.machine import Machine
    from trochia.program import Program


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """One program on one machine.

    Attributes
    ----------
    path
        The path as commanded.
    size
        Lengths, counts and extents of the programmed path.
    trajectory
        Motion over time.
    deviation
        How far input shaping takes it off its path; None where nothing is shaped.
    """

    program: Program
    machine: Machine
    path: Toolpath
    size: Measure
    trajectory: Trajectory
    deviation: Deviation | None = None

    def programmed(self) -> Toolpath:
        """Return the path as written, without blends, each segment one move; it is built at each call."""
        return build(self.program, self.machine, blend=False)

    @property
    def time_s(self) -> float:
        """Whole time [s]."""
        return self.trajectory.duration

    @property
    def feed_length_mm(self) -> float:
        """Programmed way at the feed [mm]."""
        return self.size.feed_length

    @property
    def rapid_length_mm(self) -> float:
        """Programmed way of the rapids [mm]."""
        return self.size.rapid_length

    @property
    def extents(self) -> dict[str, list[float]]:
        """Least and greatest position of each axis, start included [mm, degree]."""
        return by_axis(self.path.axes, self.size.extents)

    @property
    def feed_extents(self) -> dict[str, list[float]]:
        """Least and greatest position of each axis in feed moves [mm, degree]; empty without any."""
        return by_axis(self.path.axes, self.size.feed_extents) if self.size.feed_moves else {}

    def line_times(self) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
        """Return the source lines that move, rising, and the seconds of motion in each (lines,), (lines,)."""
        # not np.unique: counting needs no sorting
        numbers = self.program.moves["line"]
        lines = np.flatnonzero(np.bincount(numbers)).astype(np.uint32)
        seconds = np.bincount(numbers, self.trajectory.move_times).astype(np.float64)
        return lines, seconds[lines]

    def figures(self) -> dict[str, Any]:
        """Return what `trochia plan --json` prints; keys carry their units."""
        return {
            "time_s": self.time_s,
            **{f"{cause}_s": seconds for cause, seconds in self.trajectory.times.items()},
            "profile": self.trajectory.profile,
            "lines": self.program.lines,
            "moves": self.size.moves,
            "feed_moves": self.size.feed_moves,
            "feed_length_mm": self.feed_length_mm,
            "rapid_length_mm": self.rapid_length_mm,
            "extents": self.extents,
            "feed_extents": self.feed_extents,
            "peaks": self.trajectory.peaks,
            "shaping": self._shaping(),
        }

    def _shaping(self) -> dict[str, Any] | None:
        """Return what input shaping there is, and what it costs; None without any."""
        shaping = self.trajectory.shaping
        if shaping is None or self.deviation is None:
            return None
        return {
            "axes": {axis.name: {"shaper": axis.resonance.shaper, "frequency_hz": axis.resonance.frequency,
                                 "damping": axis.resonance.damping}
                     for axis in self.machine.axes if axis.resonance is not None and axis.resonance.shaper},
            "delay_s": shaping.delay,
            "deviation_mm": self.deviation.peak,
            "deviation_line": self.deviation.line,
        }  # fmt: skip


def make(program: Program, machine: Machine, *, profile: str | None = None) -> Plan:
    """Return the plan of a program, whether or not it fits the travel (:mod:`trochia.analysis.travel` says).

    Parameters
    ----------
    profile
        Name of a velocity profile; without it the machine's own, else the planner's default.
    """
    name = profile_of(machine, profile)
    path = path_of(program, machine, PROFILES[name])
    trajectory = plan_motion(path, machine, program=program, profile=name)
    return Plan(
        program=program,
        machine=machine,
        path=path,
        size=measure_program(program, machine),
        trajectory=trajectory,
        deviation=deviation(trajectory, machine.servo_period),
    )


def by_axis(letters: str, bounds: NDArray[np.float64]) -> dict[str, list[float]]:
    """Return bounds (2, n) as {axis: [least, greatest]}."""
    return {letter: [float(low), float(high)] for letter, low, high in zip(letters, *bounds, strict=True)}
