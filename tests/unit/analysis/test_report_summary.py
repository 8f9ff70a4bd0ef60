"""The report's words and tables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.report import AxisSummary, MotionSamples, ReportData, TimeParts, summary, texts


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.000 s"), (2.0625, "2.062 s"), (9.9996, "10.0 s"), (59.94, "59.9 s"), (59.96, "1 min 00.0 s"),
        (83.4, "1 min 23.4 s"), (3599.97, "1 h 00 min 00 s"), (7509, "2 h 05 min 09 s"),
    ],
)  # fmt: skip
def test_durations(seconds, text):
    assert texts.duration(seconds) == text


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [(1319.713, 1, "1,319.7"), (-0.0001, 3, "0"), (-2.5, 3, "−2.5"), (8.0, 3, "8"), (1200.0, 0, "1,200")],  # noqa: RUF001
)
def test_numbers(value, digits, text):
    assert texts.number(value, digits) == text


def test_verdicts(contour, failing):
    assert summary.verdict_text(contour) == "It will run, with 2 warnings"
    assert summary.verdict_text(failing) == "It will not run: 1 error"
    assert summary.verdict_text(replace(contour, problems=())) == "It will run"
    assert summary.verdict_text(replace(contour, problems=contour.problems[:1])) == "It will run, with 1 warning"


def test_time_parts_add_up_and_leave_out_what_is_not(contour):
    parts = summary.time_parts(contour)
    assert [part.name for part in parts] == ["motion", "dwell", "spindle"]
    assert sum(part.share for part in parts) == pytest.approx(1)


def test_peaks_compare_with_limits_and_rounding_is_no_excess(contour):
    axis = replace(contour.axes[0], peak_velocity=40.0 * (1 + 1e-9), peak_acceleration=801.0)
    velocity, acceleration = summary.peaks(replace(contour, axes=(axis, contour.axes[1])))[:2]
    assert velocity.share == pytest.approx(1)
    assert not velocity.over
    assert acceleration.over


def test_an_extent_outside_the_travel_is_told(contour):
    axis = replace(contour.axes[0], extent=(-30.0, 150.0))
    reach = summary.reaches(replace(contour, axes=(axis, contour.axes[1])))[0]
    assert not reach.inside
    assert (reach.start, reach.end) == (0.0, 0.5)


def test_errors_are_peaks_and_root_mean_squares(contour):
    rows = summary.errors(contour)
    assert [row.name for row in rows] == ["X following", "Y following", "contour"]
    samples = contour.samples
    error = samples.position[:, 0] - samples.actual[:, 0]
    assert rows[0].peak == np.abs(error).max()
    assert rows[0].rms == pytest.approx(np.sqrt(np.mean(error**2)))


def test_slow_lines_fall_and_know_their_length(contour):
    rows = summary.slow_lines(contour)
    seconds = [row.seconds for row in rows]
    assert seconds == sorted(seconds, reverse=True)
    assert len(rows) == summary.SLOW_LINES
    first = rows[0]  # the rapid from the origin to the first ring
    assert contour.text(first.line) == first.text
    assert first.length == pytest.approx(float(np.hypot(*contour.programmed.points[2])))


def test_wrong_shapes_are_refused():
    time = np.array((0.0, 1.0))
    table = np.zeros((2, 1))
    good = {"time": time, "position": table, "velocity": table, "acceleration": table, "speed": time,
            "line": np.ones(2, np.int64)}  # fmt: skip
    with pytest.raises(ValueError, match="line has 3 rows, not 2"):
        MotionSamples(**{**good, "line": np.ones(3, np.int64)})
    with pytest.raises(ValueError, match="time must rise"):
        MotionSamples(**{**good, "time": time[::-1]})
    axis = AxisSummary(name="X", unit="mm", travel=(0, 1), velocity=1, acceleration=1)
    with pytest.raises(ValueError, match="1 columns for 2 axes"):
        ReportData(program="p", source=(), machine="m", machine_description="", axes=(axis, axis), ok=True,
                   time=TimeParts(), samples=MotionSamples(**good))  # fmt: skip
    with pytest.raises(ValueError, match="unit of axis X"):
        AxisSummary(name="X", unit="in", travel=(0, 1), velocity=1, acceleration=1)
