"""The few honest calls, against closed forms and the source's own facts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import trochia
from trochia.errors import OutOfTravelError, PlanningError

ROOT = Path(__file__).parents[2]
SQUARE = "G21 G90 G17 {mode}\nF6000\nG1 X40\nY40\nX0\nY0\nM2\n"


@pytest.fixture(scope="module")
def mill():
    return trochia.load("reference-mill")


def test_a_line_from_rest_to_rest_takes_its_formula(mill: object):
    # 50 mm/s at 800 mm/s²: 100/50 + 50/800; with 20,000 mm/s³ 800/20,000 more
    line = trochia.gcode("G21 G61 G1 X100 F3000\nM2\n")
    assert trochia.plan(line, mill, profile="trapezoid").time_s == pytest.approx(2.0625, abs=1e-12)
    assert trochia.plan(line, mill).time_s == pytest.approx(2.1025, abs=1e-9)


def test_a_square_with_exact_stops_takes_its_formula(mill: object):
    # each side: 40 mm at 100 mm/s, and 100 mm/s of ramps at 800 mm/s²
    square = trochia.gcode(SQUARE.format(mode="G61.1"))
    assert trochia.plan(square, mill, profile="trapezoid").time_s == pytest.approx(2.1, abs=1e-12)
    assert trochia.plan(square, mill).time_s == pytest.approx(2.26, abs=1e-9)


def test_blending_is_faster_and_looser_is_faster_still(mill: object):
    squares = [trochia.gcode(SQUARE.format(mode=mode)) for mode in ("G61.1", "G64P0.01", "G64P1")]
    times = [trochia.plan(square, mill, profile="trapezoid").time_s for square in squares]
    assert times == sorted(times, reverse=True)
    assert times[2] < times[1] < times[0]


@pytest.mark.parametrize(
    ("name", "length", "moves", "x", "y"),
    [
        ("contour", 1319.713, 194, [8.006, 91.992], [8.008, 91.994]),
        ("hatch", 2107.600, 160, [5.0, 95.0], [5.0, 95.0]),
    ],
)
def test_the_specimens_facts(name: str, length: float, moves: int, x: list[float], y: list[float]):
    table = trochia.load("xy-table")
    plan = trochia.plan(trochia.read(ROOT / "programs" / f"{name}.ngc", table), table)
    assert plan.feed_length_mm == pytest.approx(length, abs=5e-4)
    assert plan.size.feed_moves == moves
    assert plan.feed_extents["X"] == pytest.approx(x, abs=5e-4)
    assert plan.feed_extents["Y"] == pytest.approx(y, abs=5e-4)


def test_motion_begins_inside_the_travel():
    lathe = trochia.load("lathe")
    start = trochia.gcode("M2\n", lathe).start
    for axis, column in zip(lathe.axes, lathe.columns, strict=True):
        assert axis.minimum <= start[column] <= axis.maximum


def test_out_of_travel_names_the_line_and_how_far(mill: object):
    with pytest.raises(OutOfTravelError) as caught:
        trochia.plan(trochia.gcode("G21 F600\nG1 X10\nG1 X510\nM2\n", name="p.ngc"), mill)
    assert str(caught.value).startswith("p.ngc:3: X would go to 510.000 mm, 10.000 mm beyond its travel of -500 to 500")


def test_an_arc_is_held_to_the_travel_by_its_bulge_not_its_ends(mill: object):
    # from (0, 490) a half circle of radius 15 to the right: ends inside, Y reaches 505 at its top
    text = "G21 F600 G17\nG0 X-15 Y490\nG2 X15 Y490 I15 J0\nM2\n"
    with pytest.raises(OutOfTravelError, match=r"Y would go to 505\.000"):
        trochia.plan(trochia.gcode(text), mill)


def test_check_says_where_it_would_fit(mill: object):
    text = "G21 F600 M3 S100\nG0 X490\nG1 X530 Y-600\nM5\nM2\n"
    verdict = trochia.check(text, mill)
    assert not verdict.ok
    assert verdict.problems[0].hint == "It fits with the part at another place: --at X-30Y100"
    assert trochia.check(text, mill, at={"X": -30.0, "Y": 100.0}).ok


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("G21 F600\nG0 X0\nG1 X600\nX-600\nM2\n", "The part is larger than the travel"),
        ("G21 F600\nG91 G0 X400\nG1 X200\nM2\n", "An offset does not help"),
    ],
)
def test_check_does_not_promise_an_offset_that_would_not_help(mill: object, text: str, hint: str):
    first = trochia.check(text, mill).problems[0]
    assert first.hint is not None
    assert first.hint.startswith(hint)


def test_check_names_the_first_bad_line_and_counts_the_others(mill: object):
    verdict = trochia.check("G21 F100\nG1 Q5\nG1 X1\nG1 X3Y\nG77\nM2\n", mill)
    assert [(p.line, p.severity.value) for p in verdict.problems] == [(2, "error")]
    assert verdict.more == 2
    every = trochia.check("G21 F100\nG1 Q5\nG1 X1\nG1 X3Y\nG77\nM2\n", mill, first_only=False)
    assert [p.line for p in every.problems] == [2, 4, 5]


def test_an_axis_the_machine_lacks_is_a_planning_error():
    with pytest.raises(PlanningError, match="axis Z"):
        trochia.plan(trochia.gcode("G21 F100\nG1 Z5\nM2\n"), trochia.load("xy-table"))


def test_feed_above_the_limit_is_slowed_and_told(mill: object):
    verdict = trochia.check("G21 M3 S100\nG1 X100 F60000\nM5\nM2\n", mill)
    assert verdict.ok
    assert [(p.code, p.line) for p in verdict.problems] == [("feed-slowed", 2)]
    # 200 mm/s at 800 mm/s² and 20,000 mm/s³: 58 mm of ramps, the rest at full speed
    assert verdict.time_s == pytest.approx(100 / 200 + 200 / 800 + 800 / 20_000)


def test_margins_are_what_is_left(mill: object):
    margins = trochia.check("G21 M3 S100\nG1 X100 F3000\nM5\nM2\n", mill).figures()["margins"]
    assert margins["X"]["speed"] == pytest.approx(1 - 50 / 200)
    assert margins["Y"]["speed"] == pytest.approx(1.0)


def test_the_twin_goes_where_the_plan_goes(mill: object):
    plan = trochia.plan(trochia.gcode(SQUARE.format(mode="G64P0.05")), mill)
    recording = trochia.simulate(plan)
    assert recording.time[-1] == pytest.approx(plan.time_s, abs=0.002)
    assert recording["X.commanded"].max() == pytest.approx(40.0, abs=1e-9)
    np.testing.assert_allclose(recording["X.commanded"], plan.trajectory.position(recording.time)[:, 0])


def test_every_public_name_is_there():
    for name in trochia.__all__:
        assert callable(getattr(trochia, name))
    with pytest.raises(AttributeError):
        trochia.no_such_name  # noqa: B018
