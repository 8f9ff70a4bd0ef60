"""The report's words and tables: verdict, time, extents, peaks against limits, errors, slow lines.

In: :class:`ReportData`.  Out: small frozen rows that the template prints as they are.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.report.texts import count, duration, number, percent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.report.data import AxisSummary, Range, ReportData

#: A peak may exceed its limit by rounding alone; only beyond this share of it is it shown as a fault.
_ROUNDING = 1e-6
SLOW_LINES = 20
#: Errors below this are told in micrometres [mm].
_SMALL = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class TimePart:
    """One part of the total time: name, text, and share of the total."""

    name: str
    text: str
    share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """A greatest value against its limit; share is their quotient, None where the machine sets no limit."""

    axis: str
    quantity: str
    value: float
    limit: float | None
    unit: str

    @property
    def share(self) -> float | None:
        """Peak as a fraction of the limit."""
        return None if self.limit is None else self.value / self.limit

    @property
    def over(self) -> bool:
        """The limit is exceeded by more than rounding."""
        return self.share is not None and self.share > 1 + _ROUNDING


@dataclass(frozen=True, slots=True, kw_only=True)
class Reach:
    """How far an axis goes inside its travel; bar positions are fractions of the travel, cut at its ends."""

    axis: AxisSummary
    start: float
    end: float
    inside: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorRow:
    """Peak and root mean square of an error, in a unit that suits them, with as many decimals as matter."""

    name: str
    unit: str
    peak: float
    rms: float
    digits: int = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SlowLine:
    """A source line that costs time: share of the total, way, mean speed (None where it moves not), and what binds."""

    line: int
    text: str
    seconds: float
    share: float
    length: float | None
    speed: float | None
    limit: str | None = None


def verdict_text(data: ReportData) -> str:
    """Return the verdict as a sentence a person would say."""
    found = Counter(problem.severity.value for problem in data.problems)
    if data.verdict == "no":
        return f"It will not run: {count(found['error'], 'error')}" if found["error"] else "It will not run"
    return f"It will run, with {count(found['warning'], 'warning')}" if data.verdict == "warnings" else "It will run"


def time_parts(data: ReportData) -> list[TimePart]:
    """Return the parts of the total time that are not zero, motion always."""
    time = data.time
    parts = {"motion": time.motion, "dwell": time.dwell, "spindle": time.spindle, "tool change": time.tool}
    return [
        TimePart(name=name, text=duration(seconds), share=seconds / (time.total or 1.0))
        for name, seconds in parts.items()
        if seconds or name == "motion"
    ]


def peaks(data: ReportData) -> list[Peak]:
    """Return the peaks of every axis and of the path, each with its limit."""
    rows: list[Peak] = []
    for axis in data.axes:
        quantities: list[tuple[str, float, float | None, str]]
        quantities = [("velocity", axis.peak_velocity, axis.velocity, f"{axis.unit}/s"),
                      ("acceleration", axis.peak_acceleration, axis.acceleration, f"{axis.unit}/s²")]  # fmt: skip
        if axis.peak_jerk is not None:
            quantities.append(("jerk", axis.peak_jerk, axis.jerk, f"{axis.unit}/s³"))
        rows += [Peak(axis=axis.name, quantity=what, value=value, limit=limit, unit=unit)
                 for what, value, limit, unit in quantities]  # fmt: skip
    if data.samples is not None and len(data.samples.speed):
        rows.append(Peak(axis="path", quantity="velocity", value=float(data.samples.speed.max()),
                         limit=data.path_velocity, unit="mm/s"))  # fmt: skip
    return rows


def reaches(data: ReportData) -> list[Reach]:
    """Return for every axis that has an extent where it lies in the travel."""
    return [_reach(axis, axis.extent) for axis in data.axes if axis.extent is not None]


def _reach(axis: AxisSummary, extent: Range) -> Reach:
    low, high = axis.travel
    start, end = (min(1.0, max(0.0, (value - low) / (high - low))) for value in extent)
    return Reach(axis=axis, start=start, end=end, inside=low <= extent[0] and extent[1] <= high)


def errors(data: ReportData) -> list[ErrorRow]:
    """Return following errors by axis and the contour error, where a simulation gave them."""
    samples = data.samples
    if samples is None or not len(samples.time):
        return []
    rows: list[ErrorRow] = []
    following = samples.following_error
    if following is not None:
        rows += [_error(f"{axis.name} following", axis.unit, following[:, i]) for i, axis in enumerate(data.axes)]
    if samples.contour_error is not None:
        rows.append(_error("contour", "mm", samples.contour_error))
    return rows


def _error(name: str, unit: str, values: NDArray[np.float64]) -> ErrorRow:
    peak, rms = float(np.max(np.abs(values))), float(np.sqrt(np.mean(values**2)))
    if unit == "mm" and peak < _SMALL:
        return ErrorRow(name=name, unit="µm", peak=1000 * peak, rms=1000 * rms, digits=2)
    return ErrorRow(name=name, unit=unit, peak=peak, rms=rms)


def slow_lines(data: ReportData) -> list[SlowLine]:
    """Return the lines that cost most time, the costliest first; lines of no cost are left out."""
    times = data.line_times
    if times is None:
        return []
    order = [i for i in np.argsort(-times.seconds, kind="stable")[:SLOW_LINES] if times.seconds[i] > 0]
    lengths = _lengths(data, times.line[order])
    total = data.time.total or 1.0
    return [
        SlowLine(line=line, text=data.text(line), seconds=seconds, share=seconds / total, length=length or None,
                 speed=length / seconds if length else None, limit=_limit(data, line))
        for line, seconds, length
        in zip(times.line[order].tolist(), times.seconds[order].tolist(), lengths, strict=True)
    ]  # fmt: skip


def _limit(data: ReportData, line: int) -> str | None:
    """Return the limit that costs a line most of its time, with its part where that is not all."""
    found = None if data.reasons is None else data.reasons.lines.get(line)
    if found is None:
        return None
    limit, part = found
    return limit if round(part, 2) >= 1.0 else f"{limit}, {percent(part)}"


def _lengths(data: ReportData, lines: NDArray[np.int64]) -> list[float]:
    """Return the programmed length of each of ``lines`` in linear axes [mm]."""
    if data.programmed is None or not len(data.programmed.points):
        return [0.0] * len(lines)
    linear = [i for i, axis in enumerate(data.axes) if axis.unit == "mm"][:3]
    steps = np.linalg.norm(np.diff(data.programmed.points[:, linear], axis=0), axis=1)
    return [float(steps[data.programmed.line[1:] == line].sum()) for line in lines]


def facts(data: ReportData) -> list[tuple[str, str]]:
    """Return labels and values of what is known of the program as a whole."""
    rows = [
        ("Feed length", f"{number(data.feed_length, 1)} mm"),
        ("Rapid length", f"{number(data.rapid_length, 1)} mm"),
        ("Moves", f"{data.moves:,}"),
        ("Program lines", f"{len(data.source):,}"),
    ]
    if data.time.motion > 0:
        mean = (data.feed_length + data.rapid_length) / data.time.motion
        rows.append(("Mean speed in motion", f"{number(mean, 2)} mm/s"))
    if data.shaping is not None:
        rows.append(("Input shaping", data.shaping))
    if data.lost_steps is not None:
        lost = {joint: steps for joint, steps in data.lost_steps.items() if steps}
        rows.append(("Lost steps", ", ".join(f"{joint}: {steps:,}" for joint, steps in lost.items()) or "none"))
    return rows
