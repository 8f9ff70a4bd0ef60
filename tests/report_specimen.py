"""Made-up motion for the report's tests: a ring of chords, circles and a many-sided figure, at believable speeds.

The geometry is that of a laser contour specimen; the motion is an exact trapezoid along it with slow corners, and the
actual position lags as a loop of a given velocity gain does.
"""

from __future__ import annotations

import numpy as np

from trochia.analysis.problems import Problem, Severity
from trochia.analysis.report import AxisSummary, LineTimes, MotionSamples, ProgrammedPath, ReportData, TimeParts
from trochia.analysis.report.deviation import deviation

LAG = 1 / 60  # s: following error over velocity
HOSTILE = "(</script><script>alert(1)</script> & \"quotes\" 'n' <b>bold</b> ]]> <!-- É)"


def contour(*, depth: bool = False, over: bool = False, period: float = 0.001) -> ReportData:
    """Return the report of the contour specimen; with ``depth`` it cuts in three levels of Z."""
    points, rapid, texts = _program(depth=depth)
    acceleration, speeds = 800.0, np.where(rapid, 40.0, 33.0)
    time, position, speed, line = _drive(points, speeds, acceleration, period)
    velocity = np.gradient(position, time, axis=0)
    accelerations = np.gradient(velocity, time, axis=0)
    actual = _lag(position, period)
    contour_error = np.linalg.norm(deviation(position, actual, np.arange(len(time))), axis=1)
    names = "XYZ" if depth else "XY"
    line_of_point = np.arange(1, len(points) + 1) + 3
    seconds = np.bincount(line, minlength=len(points) + 4) * period
    busy = np.flatnonzero(seconds)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    problems = (
        Problem(severity=Severity.WARNING, code="feed-slowed", file="contour.ngc", line=6, column=21,
                message="feed 6000 mm/min is above what X allows; 1980 mm/min is used",
                hint="Lower F, or raise axes.X.velocity if the nut bears it."),
        Problem(severity=Severity.WARNING, code="beam-off", file="contour.ngc", line=len(texts), column=0,
                message="feed with the beam off"),
    )  # fmt: skip
    if over:
        problems = (Problem(severity=Severity.ERROR, code="travel", file="contour.ngc", line=9, column=4,
                            message="Y would leave its travel by 12.4 mm", hint="Placed at Y-12.4 it would fit."),
                    *problems)  # fmt: skip
    return ReportData(
        program="contour.ngc",
        source=texts,
        machine="xy-table",
        machine_description="Two lead-screw stages that carry the mirrors of a laser",
        axes=tuple(
            AxisSummary(
                name=name,
                unit="mm",
                travel=(-30.0, 10.0) if name == "Z" else (0.0, 300.0),
                velocity=30.0 if over and name == "Y" else 40.0,
                acceleration=acceleration,
                extent=(float(position[:, i].min()), float(position[:, i].max())),
                feed_extent=(8.0, 92.0) if i < 2 else None,
                peak_velocity=float(np.abs(velocity[:, i]).max()),
                peak_acceleration=float(min(acceleration, np.abs(accelerations[:, i]).max())),
            )
            for i, name in enumerate(names)
        ),
        ok=not over,
        problems=problems,
        time=TimeParts(motion=float(time[-1]), dwell=1.5, spindle=0.8),
        moves=len(points) - 1,
        feed_length=float(steps[~rapid[1:]].sum()),
        rapid_length=float(steps[rapid[1:]].sum()),
        path_velocity=50.0,
        programmed=ProgrammedPath(points=points, rapid=rapid, line=line_of_point),
        samples=MotionSamples(
            time=time,
            position=position,
            velocity=velocity,
            acceleration=accelerations,
            speed=speed,
            line=line,
            actual=actual,
            contour_error=contour_error,
        ),
        line_times=LineTimes(line=busy, seconds=seconds[busy]),
        lost_steps={"X": 0, "Y": 0},
    )


def _program(*, depth: bool):
    """Return points (n, k), whether each is reached in rapid (n,), and source texts."""
    rings = [_ring(42.0, 48), *(_ring(radius, 160) for radius in (39.0, 36.0, 33.0, 30.0)), _figure(28.0, 32)]
    levels = (-1.0, -2.0, -3.0) if depth else (0.0,)
    points, rapid = [np.array((0.0, 0.0, 5.0))], [True]
    for level in levels:
        for ring in rings:
            start = ring[0]
            for target in ((*points[-1][:2], 5.0), (*start, 5.0)):
                points.append(np.array(target))
                rapid.append(True)
            for x, y in ring if not depth else [start, *ring]:
                points.append(np.array((x, y, level)))
                rapid.append(False)
    table, fast = np.array(points), np.array(rapid)
    if not depth:
        table = table[:, :2]
    texts = ["G21 G90 G17", HOSTILE, "M3"]
    letters = "XYZ"[: table.shape[1]]
    texts += [
        ("G0 " if quick else "G1 ") + " ".join(f"{a}{v:.3f}" for a, v in zip(letters, p, strict=True))
        for p, quick in zip(table, fast, strict=True)
    ]
    return table, fast, [*texts, "M5", "M2"]


def _ring(radius: float, sides: int):
    angle = -np.linspace(0, 2 * np.pi, sides + 1) + 1.2
    return 50 + radius * np.column_stack((np.cos(angle), np.sin(angle)))


def _figure(radius: float, sides: int):
    """Return a rosette: its radius swings, so that speed does too."""
    angle = -np.linspace(0, 2 * np.pi, 8 * sides + 1) + 1.2
    wide = radius - 4 - 4 * np.cos(8 * angle)
    return 50 + wide[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))


def _drive(points, speeds, acceleration, period):
    """Return time, position, path speed and line of a trapezoid along chords, slowed at corners by their angle."""
    steps = np.diff(points, axis=0)
    length = np.linalg.norm(steps, axis=1)
    keep = length > 1e-9
    line = (np.arange(1, len(points)) + 4)[keep]
    begin, steps, length, top = points[:-1][keep], steps[keep], length[keep], speeds[1:][keep]
    unit = steps / length[:, None]
    turn = np.arccos(np.clip(np.sum(unit[:-1] * unit[1:], axis=1), -1, 1))
    corner = np.concatenate(((0.0,), np.minimum(np.minimum(top[:-1], top[1:]), 1.2 / np.maximum(turn, 1e-6)), (0.0,)))
    corner[1:-1][turn > 0.6] = 0.0
    for order in (range(len(length)), range(len(length) - 1, -1, -1)):
        for i in order:
            a, b = (i, i + 1) if order.step > 0 else (i + 1, i)
            corner[b] = min(corner[b], np.sqrt(corner[a] ** 2 + 2 * acceleration * length[i]))
    peak = np.minimum(top, np.sqrt((2 * acceleration * length + corner[:-1] ** 2 + corner[1:] ** 2) / 2))
    up, down = (peak - corner[:-1]) / acceleration, (peak - corner[1:]) / acceleration
    ramps = (peak**2 - corner[:-1] ** 2 + peak**2 - corner[1:] ** 2) / (2 * acceleration)
    flat = np.maximum(0, length - ramps) / peak
    ends = np.cumsum(up + flat + down)
    time = np.arange(0, ends[-1], period)
    i = np.minimum(np.searchsorted(ends, time, side="right"), len(ends) - 1)
    into = time - np.concatenate(((0.0,), ends))[i]
    late = np.maximum(0, into - up[i] - flat[i])
    speed = np.minimum(peak[i], corner[i] + acceleration * into) - acceleration * late
    rise = np.minimum(into, up[i])
    way = corner[i] * rise + acceleration * rise**2 / 2 + peak[i] * np.clip(into - up[i], 0, flat[i])
    way += peak[i] * late - acceleration * late**2 / 2
    position = begin[i] + unit[i] * np.minimum(way, length[i])[:, None]
    return time, position, np.maximum(0, speed), line[i]


def _lag(position, period):
    """Return a first-order loop's answer to ``position`` (m, k)."""
    actual = np.empty_like(position)
    actual[0] = position[0]
    share = 1 - np.exp(-period / LAG)
    for i in range(1, len(position)):
        actual[i] = actual[i - 1] + share * (position[i] - actual[i - 1])
    return actual
