"""What the report shows of a plan and its recording, put together.

In: a verdict with its plan, the recording of the run, the program's text.  Out: :class:`ReportData`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.errors import contour_distances, lost_steps
from trochia.analysis.explain import explain
from trochia.analysis.report import (
    AxisSummary,
    LineTimes,
    MotionSamples,
    ProgrammedPath,
    ReportData,
    TimeParts,
)
from trochia.analysis.report.reasons import reasons
from trochia.analysis.report.summary import SLOW_LINES
from trochia.analysis.shaped import words
from trochia.machine.axes import AxisKind
from trochia.toolpath import SegmentKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.analysis.check import Verdict
    from trochia.analysis.plan import Plan
    from trochia.analysis.report.reasons import Reasons
    from trochia.machine.axes import Axis
    from trochia.recorder import Recording
    from trochia.toolpath import Toolpath

MOST_SAMPLES = 400_000  #: instants the report looks at; of a longer recording it takes every second, third, … one
CHORD = np.radians(3)  #: turn of one chord of a drawn arc


def report_data(verdict: Verdict, plan: Plan, recording: Recording, source: Sequence[str]) -> ReportData:
    """Return everything the report shows of a simulated plan."""
    lines, seconds = plan.line_times()
    samples = _samples(plan, recording)
    return ReportData(
        program=plan.program.name,
        source=source,
        machine=plan.machine.name,
        machine_description=plan.machine.description,
        axes=tuple(_axis(plan, axis) for axis in plan.machine.axes),
        ok=verdict.ok,
        time=TimeParts(**plan.trajectory.times),
        problems=verdict.problems,
        moves=plan.size.moves,
        feed_length=plan.feed_length_mm,
        rapid_length=plan.rapid_length_mm,
        path_velocity=plan.machine.path.velocity,
        path_acceleration=plan.machine.path.acceleration,
        programmed=_programmed(plan),
        samples=samples,
        reasons=_reasons(plan, samples, lines[np.argsort(-seconds, kind="stable")[:SLOW_LINES]]),
        shaping=_shaping(plan),
        line_times=LineTimes(line=lines.astype(np.int64), seconds=seconds),
        lost_steps=lost_steps(recording, plan.machine),
    )


def _reasons(plan: Plan, samples: MotionSamples, lines: NDArray[np.uint32]) -> Reasons | None:
    """Return which limits bind; None where nothing moves."""
    return reasons(explain(plan), plan.trajectory, samples.time, lines) if plan.trajectory.schedule else None


def _shaping(plan: Plan) -> str | None:
    """Return the input shaping in words, and how far it takes motion off its path; None without any."""
    return None if plan.deviation is None else f"{words(plan.machine)}, {plan.deviation.peak:.3f} mm off the path"


def _axis(plan: Plan, axis: Axis) -> AxisSummary:
    peaks = plan.trajectory.peaks[axis.name]
    low, high = plan.extents[axis.name]
    feed = plan.feed_extents.get(axis.name)
    return AxisSummary(
        name=axis.name,
        unit="mm" if axis.kind is AxisKind.LINEAR else "deg",
        travel=(axis.minimum, axis.maximum),
        velocity=axis.velocity,
        acceleration=axis.acceleration,
        jerk=axis.jerk,
        extent=(low, high),
        feed_extent=None if feed is None else (feed[0], feed[1]),
        peak_velocity=peaks["velocity"] or 0.0,
        peak_acceleration=peaks["acceleration"] or 0.0,
        peak_jerk=peaks["jerk"],
    )


def _programmed(plan: Plan) -> ProgrammedPath:
    """Return the path as written, arcs as chords."""
    path = plan.programmed()
    chords = _chords(path)
    rows = np.repeat(np.arange(len(path)), chords)
    step = np.arange(len(rows)) - np.repeat(np.cumsum(chords) - chords, chords) + 1
    points = path.points(rows, path.segments["length"][rows] * step / chords[rows])
    lines = plan.program.moves["line"][path.segments["move"]].astype(np.int64)
    return ProgrammedPath(
        points=np.concatenate([path.start[None, :], points]),
        rapid=np.concatenate([[False], ~path.is_feed[rows]]),
        line=np.concatenate([lines[:1], lines[rows]]) if len(path) else np.zeros(1, np.int64),
    )


def _chords(path: Toolpath) -> NDArray[np.intp]:
    """Return into how many chords each segment is drawn (k,)."""
    chords = np.ones(len(path), dtype=np.intp)
    arcs = np.flatnonzero(path.segments["kind"] == SegmentKind.ARC)
    if arcs.size:
        begin = path.points(arcs, np.zeros(arcs.size), 2)
        # |x''| = 1/r on a circle, so length times |x''| is the angle it turns
        turned = np.linalg.norm(begin, axis=1) * path.segments["length"][arcs]
        chords[arcs] = np.maximum(np.ceil(turned / CHORD), 1).astype(np.intp)
    return chords


def _samples(plan: Plan, recording: Recording) -> MotionSamples:
    """Return the run as the report plots it."""
    step = max(1, -(-len(recording) // MOST_SAMPLES))
    time = np.minimum(recording.time[::step], plan.time_s)
    keep = np.concatenate([[True], np.diff(time) > 0])
    time = time[keep]

    def channel(name: str) -> NDArray[np.float64]:
        return np.asarray(recording[name][::step][keep], dtype=np.float64)

    names = [axis.name for axis in plan.machine.axes]

    def of_joints(quantity: str) -> tuple[NDArray[np.float64] | None, tuple[tuple[str, int], ...]]:
        """Return a quantity (m, q) of the joints that have it, with their names and the axis each moves most."""
        rows = zip(plan.machine.joints, np.abs(plan.machine.kinematics.matrix), strict=True)
        found = tuple((joint.name, int(row.argmax())) for joint, row in rows
                      if f"joint.{joint.name}.{quantity}" in recording)  # fmt: skip
        table = [channel(f"joint.{name}.{quantity}") for name, _ in found]
        return (np.stack(table, axis=1) if table else None), found

    (load_angle, load_joints), (current, current_joints) = of_joints("load_angle"), of_joints("current")
    return MotionSamples(
        time=time,
        position=np.stack([channel(f"{name}.commanded") for name in names], axis=1),
        velocity=plan.trajectory.velocity(time),
        acceleration=plan.trajectory.acceleration(time),
        speed=channel("path.speed"),
        line=channel("path.line").astype(np.int64),
        actual=np.stack([channel(f"{name}.actual") for name in names], axis=1),
        contour_error=contour_distances(recording)[::step][keep],
        load_angle=load_angle,
        load_joints=load_joints,
        current=current,
        current_joints=current_joints,
    )
