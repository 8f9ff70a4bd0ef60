"""Time by the limit that binds: its sums are the plan's times, and its stops are where motion stops."""

from __future__ import annotations

import numpy as np
import pytest

from trochia import api
from trochia.analysis.explain import explain
from trochia.planner import PROFILES
from trochia.planner.binding import Kind

MILL = api.load("reference-mill")
PART = "G64 P0.02\nF4800\nG1 X30\nG3 X40 Y10 J10\nG1 Y30\nX0 Y31\nG4 P0.5\nG0 X0 Y0\nM2\n"


def explained(text, profile):
    plan = api.plan(api.gcode(text, MILL), MILL, profile=profile)
    return plan, explain(plan)


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_shares_sum_to_the_whole_time_and_lines_to_theirs(profile):
    plan, why = explained(PART, profile)
    assert sum(share.seconds for share in why.shares) == pytest.approx(plan.time_s)
    lines, seconds = plan.line_times()
    for line, time in zip(lines.tolist(), seconds.tolist(), strict=True):
        assert sum(part for _, part in why.of_line(line)) == pytest.approx(time)
    assert [share.seconds for share in why.shares] == sorted((s.seconds for s in why.shares), reverse=True)


def test_a_dwell_is_told_as_rest():
    _, why = explained(PART, "trapezoid")
    (rest,) = [share for share in why.shares if share.kind is Kind.REST]
    assert rest.seconds == pytest.approx(0.5)
    assert rest.used == 0.0


def test_time_beside_stops_is_that_of_the_ramps():
    # 0.125 s up to 100 mm/s and as long down, at each of four corners with a stop
    _, why = explained("G61.1\nG1 X40 F6000\nY40\nX0\nY0\nM2\n", "trapezoid")
    assert sum(share.beside_stops for share in why.shares) == pytest.approx(8 * 0.125)
    assert {share.limit for share in why.shares if share.beside_stops} == {"axis X acceleration", "axis Y acceleration"}
    at = np.array([0.01, 0.26, 0.52, 0.53, 2.09])
    assert why.beside_stop(at).tolist() == [True, False, True, True, True]


def test_without_motion_there_is_rest_or_nothing():
    _, why = explained("G4 P1\nM2\n", "trapezoid")
    assert [share.limit for share in why.shares] == ["at rest"]
    _, why = explained("M2\n", "trapezoid")
    assert not why.shares
    assert not why.beside_stop(np.array([0.0])).any()
