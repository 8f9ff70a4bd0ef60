"""What the report says of the limits that bind: the plan's own times, and the limit of each sample of the motion."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np
import pytest

from trochia import api
from trochia.analysis.explain import explain
from trochia.analysis.report import render_report
from trochia.analysis.report.payload import payload
from trochia.analysis.report.reasons import GROUPS, reasons

MILL = api.load("reference-mill")
PART = "G61.1\nG1 X40 F6000\nG64\nG2 X0 I-20 J0 F9000\nG4 P0.5\nG0 Y20\nM2\n"


@pytest.fixture(scope="module")
def plan():
    return api.plan(api.gcode(PART, MILL), MILL, profile="trapezoid")


@pytest.fixture(scope="module")
def found(plan):
    return reasons(explain(plan), plan.trajectory, np.linspace(0, plan.time_s, 4001), np.array([2, 4, 5, 6]))


def test_groups_share_the_whole_time(found):
    assert sum(share for *_, share in found.groups()) == pytest.approx(1.0, abs=1e-3)
    assert [name for name, *_ in found.groups()] == [name for name in GROUPS if name in dict.fromkeys(
        name for name, *_ in found.groups())]  # fmt: skip
    assert {name for name, *_ in found.groups()} >= {"feed", "bend", "stop", "other"}


def test_each_sample_has_its_limit(plan, found):
    labels = [found.labels[label] for label in found.sample]
    assert labels[1] == ("axis X acceleration, beside a stop", "stop")
    at = round(0.25 / plan.time_s * 4000)
    assert labels[at] == ("programmed feed", "feed")
    counted = sum(group == "stop" for _, group in labels) / len(labels)
    assert counted == pytest.approx(next(share for name, _, share in found.groups() if name == "stop"), abs=2e-3)


def test_lines_tell_what_costs_them_most(found):
    assert found.lines[2][0] in {"programmed feed", "axis X acceleration"}
    assert 0.3 < found.lines[2][1] <= 1.0
    assert 5 not in found.lines  # a dwell moves nothing


def test_the_page_has_table_legend_and_a_label_for_each_point(contour, plan):
    why = reasons(explain(plan), plan.trajectory, np.linspace(0, plan.time_s, len(contour.samples.time)), np.array([2]))
    data = replace(contour, reasons=why, shaping="X zv 45 Hz, 0.012 mm off the path")
    made = payload(data)
    drawn = np.frombuffer(base64.b64decode(made["path"]["limit"]["data"]), np.uint8)
    assert len(drawn) == len(np.frombuffer(base64.b64decode(made["path"]["time"]["data"]), "<f8"))
    assert drawn.max() < len(made["limits"])
    assert {limit["group"] for limit in made["limits"]} <= set(GROUPS)
    page = render_report(data)
    assert "What binds</h2>" in page
    assert "axis X acceleration in a bend" in page
    assert "X zv 45 Hz" in page
    assert payload(contour)["limits"] is None
    assert "What binds</h2>" not in render_report(contour)
