"""What a report shows: plain values and arrays, independent of who planned or recorded them.

In: numbers of a plan and samples of a recording, put together by the caller.  Out: :class:`ReportData`, which
:func:`trochia.analysis.report.write_report` and :func:`trochia.analysis.plots.path_picture` draw.

Units are those of axis space: mm (degree on rotary axes) and s.  Array shapes: n programmed points, m samples in time,
k axes in the order of :attr:`ReportData.axes`.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Literal

import numpy as np

from trochia.analysis.problems import Severity

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from trochia.analysis.problems import Problem
    from trochia.analysis.report.reasons import Reasons

Verdict = Literal["yes", "warnings", "no"]
Range = tuple[float, float]
AXIS_UNITS = ("mm", "deg")


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSummary:
    """One axis: what the machine allows and what the program asks of it.

    Attributes
    ----------
    unit
        ``"mm"`` or ``"deg"``; every number below is in it, and in its rates per second.
    travel
        Lowest and highest position the machine reaches.
    velocity, acceleration, jerk
        Limits; jerk may be None (the machine gives none).
    extent, feed_extent
        Lowest and highest position of all motion, and of feed moves alone; None where there is no such motion.
    peak_velocity, peak_acceleration, peak_jerk
        Greatest magnitudes in the plan; jerk is None in trapezoid mode.
    """

    name: str
    unit: str
    travel: Range
    velocity: float
    acceleration: float
    jerk: float | None = None
    extent: Range | None = None
    feed_extent: Range | None = None
    peak_velocity: float = 0.0
    peak_acceleration: float = 0.0
    peak_jerk: float | None = None

    def __post_init__(self) -> None:
        if self.unit not in AXIS_UNITS:
            raise ValueError(f"unit of axis {self.name} must be one of {AXIS_UNITS}, not {self.unit!r}")


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeParts:
    """Where the time goes [s]."""

    motion: float = 0.0
    dwell: float = 0.0
    spindle: float = 0.0
    tool: float = 0.0

    @property
    def total(self) -> float:
        """The sum of all parts [s]."""
        return self.motion + self.dwell + self.spindle + self.tool


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgrammedPath:
    """The path as written: points (n, k), arcs as chords.

    ``rapid`` (n,) and ``line`` (n,) describe the segment that ends at the point (the first point only begins one).
    """

    points: NDArray[np.float64]
    rapid: NDArray[np.bool_]
    line: NDArray[np.int64]

    def __post_init__(self) -> None:
        _rows(self.points.shape[0], rapid=self.rapid, line=self.line)


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionSamples:
    """Motion over time, commanded and (where there is one) actual.

    Attributes
    ----------
    time
        Rising instants (m,) [s].
    position, velocity, acceleration
        Commanded, (m, k).
    speed
        Along the path (m,) [mm/s].
    line
        Source line in execution (m,), counted from 1.
    actual
        Position reached (m, k), or None without a simulation.
    contour_error
        Distance of the actual position from the programmed path (m,) [mm], or None.
    load_angle
        Of the steppers that were physics (m, q) [electrical degree], or None.
    load_joints
        Their names, and the number of the axis each moves most.
    current, current_joints
        The same of motors that were physics: their current (m, q) [A].
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    speed: NDArray[np.float64]
    line: NDArray[np.int64]
    actual: NDArray[np.float64] | None = None
    contour_error: NDArray[np.float64] | None = None
    load_angle: NDArray[np.float64] | None = None
    load_joints: tuple[tuple[str, int], ...] = ()
    current: NDArray[np.float64] | None = None
    current_joints: tuple[tuple[str, int], ...] = ()

    def __post_init__(self) -> None:
        tables = {"position": self.position, "velocity": self.velocity, "acceleration": self.acceleration}
        columns = {"speed": self.speed, "line": self.line, "actual": self.actual, "contour_error": self.contour_error,
                   "load_angle": self.load_angle, "current": self.current}  # fmt: skip
        _rows(self.time.shape[0], **tables, **columns)
        if self.time.shape[0] and not bool(np.all(np.diff(self.time) > 0)):
            raise ValueError("time must rise from sample to sample")

    @property
    def following_error(self) -> NDArray[np.float64] | None:
        """Commanded minus actual position (m, k), or None."""
        return None if self.actual is None else self.position - self.actual


@dataclass(frozen=True, slots=True, kw_only=True)
class LineTimes:
    """Seconds spent in each source line: line (q,) counted from 1, seconds (q,)."""

    line: NDArray[np.int64]
    seconds: NDArray[np.float64]

    def __post_init__(self) -> None:
        _rows(self.line.shape[0], seconds=self.seconds)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportData:
    """Everything a report shows.

    Attributes
    ----------
    program, source
        File of the program, and its lines of text (line 1 first).
    machine, machine_description
        Name and one sentence.
    ok
        The program can run; warnings do not change it.
    moves
        Non-zero moves.
    feed_length, rapid_length
        Along the path [mm].
    path_velocity, path_acceleration
        The machine's caps along the path [mm/s, mm/s²], if it has any.
    reasons
        Which limits bind, where the plan was explained.
    shaping
        Input shaping in words, where there is any.
    lost_steps
        Per joint, where a simulation counted them.
    """

    program: str
    source: Sequence[str]
    machine: str
    machine_description: str
    axes: tuple[AxisSummary, ...]
    ok: bool
    time: TimeParts
    problems: tuple[Problem, ...] = ()
    moves: int = 0
    feed_length: float = 0.0
    rapid_length: float = 0.0
    path_velocity: float | None = None
    path_acceleration: float | None = None
    programmed: ProgrammedPath | None = None
    samples: MotionSamples | None = None
    line_times: LineTimes | None = None
    reasons: Reasons | None = None
    shaping: str | None = None
    lost_steps: Mapping[str, int] | None = None

    def __post_init__(self) -> None:
        for name, table in (("programmed.points", self.programmed and self.programmed.points),
                            ("samples.position", self.samples and self.samples.position)):  # fmt: skip
            if table is not None and table.shape[1] != len(self.axes):
                raise ValueError(f"{name} has {table.shape[1]} columns for {len(self.axes)} axes")

    @property
    def name(self) -> str:
        """The program's name without its folders: a report is handed on."""
        return PurePath(self.program).name

    @property
    def verdict(self) -> Verdict:
        """``"no"``, or ``"warnings"`` when there is anything to warn of, or ``"yes"``."""
        if not self.ok:
            return "no"
        return "warnings" if any(problem.severity is Severity.WARNING for problem in self.problems) else "yes"

    def rapid_samples(self) -> NDArray[np.bool_]:
        """Return whether each sample (m,) belongs to a source line that moves in rapid."""
        line = np.zeros(0, np.int64) if self.samples is None else self.samples.line
        rapid = np.zeros(0, np.int64) if self.programmed is None else self.programmed.line[self.programmed.rapid]
        return np.isin(line, rapid)

    def text(self, line: int) -> str:
        """Return source line ``line`` (from 1) without its line ending, or an empty text where there is none."""
        return self.source[line - 1].strip() if 1 <= line <= len(self.source) else ""


def _rows(count: int, **tables: NDArray[np.generic] | None) -> None:
    """Refuse a table that has not ``count`` rows."""
    for name, table in tables.items():
        if table is not None and table.shape[0] != count:
            raise ValueError(f"{name} has {table.shape[0]} rows, not {count}")
