"""The report of a job: one HTML file that shows verdict, time, path and motion, and needs no network."""

from trochia.analysis.report.data import (
    AxisSummary,
    LineTimes,
    MotionSamples,
    ProgrammedPath,
    ReportData,
    TimeParts,
)
from trochia.analysis.report.page import render_report, write_report

__all__ = [
    "AxisSummary",
    "LineTimes",
    "MotionSamples",
    "ProgrammedPath",
    "ReportData",
    "TimeParts",
    "render_report",
    "write_report",
]
