"""Segments, parallels, rounded corners: against closed forms and laws."""

from __future__ import annotations

from itertools import pairwise
from math import cos, hypot, pi, sin, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.geometry.parallel import parallel
from trochia.geometry.rounding import rounded
from trochia.geometry.segments import Segment, lines_meet, meetings

UP, OVER = Segment(start=(0, 0), end=(0, 10)), Segment(start=(0, 10), end=(10, 10))
ARC = Segment(start=(5, 0), end=(0, 5), centre=(0, 0), sense=1)


def test_a_line_cuts_a_circle_where_pythagoras_says():
    level = Segment(start=(0, 3), end=(9, 3))
    assert meetings(level, ARC) == [(pytest.approx(4), 3)]
    assert len(lines_meet(level, ARC)) == 2


def test_circles_cut_on_their_common_chord():
    other = Segment(start=(6, 5), end=(1, 0), centre=(6, 0), sense=1)
    (point,) = meetings(ARC, other)
    assert point == (pytest.approx(3), pytest.approx(4))


def test_what_does_not_meet_does_not():
    assert meetings(UP, Segment(start=(1, 0), end=(1, 10))) == []
    assert meetings(ARC, Segment(start=(7, 0), end=(7, 9))) == []
    assert meetings(ARC, Segment(start=(20, 0), end=(20, 1), centre=(19, 0), sense=1)) == []
    assert meetings(ARC, Segment(start=(2, 0), end=(0, 2), centre=(0, 0), sense=1)) == []


def test_an_arc_shrinks_to_nothing():
    assert ARC.parallel(5.0) is None
    inner, outer = ARC.parallel(2.0), ARC.parallel(-2.0)
    assert inner is not None
    assert outer is not None
    assert (inner.radius, outer.radius) == (pytest.approx(3), pytest.approx(7))


def test_a_parallel_goes_round_outside_and_meets_inside():
    left, right = parallel([UP, OVER], 1.0), parallel([UP, OVER], -1.0)
    assert [piece.sense for piece in left] == [0, -1, 0]
    assert left[1].centre == (0, 10)
    assert [piece.end for piece in right] == [(pytest.approx(1), pytest.approx(9)), (10, pytest.approx(9))]


def test_a_short_corner_is_a_point():
    mitred = parallel([UP, OVER], 1.0, least=2.0)
    assert [piece.end for piece in mitred] == [(pytest.approx(-1), pytest.approx(11)), (10, pytest.approx(11))]


def test_a_groove_is_passed_over():
    points = [(-9.0, 0.0), (0.0, 0.0), (0.0, -5.0), (3.0, -5.0), (3.0, 0.0), (12.0, 0.0)]
    over = parallel([Segment(start=a, end=b) for a, b in pairwise(points)], 4.0)
    assert [piece.sense for piece in over] == [0, -1, -1, 0]
    assert over[1].end == (pytest.approx(1.5), pytest.approx(sqrt(16 - 1.5**2)))


def test_a_way_there_and_back_is_gone_round_its_tip():
    there, round_it, back = parallel([UP, Segment(start=UP.end, end=UP.start)], 1.0)
    assert round_it.centre == UP.end
    assert round_it.sense == -1
    assert there.end == round_it.start
    assert (there.start[0], back.end[0]) == (UP.start[0] - 1.0, UP.start[0] + 1.0)


def test_a_contour_that_crosses_itself_has_no_parallel():
    points = [(0.0, 0.0), (0.0, 10.0), (0.0, 3.0), (-5.0, 3.0)]
    with pytest.raises(ValueError, match="narrow"):
        parallel([Segment(start=one, end=other) for one, other in pairwise(points)], 1.0)


def test_a_parallel_begins_where_its_vanished_first_segment_would_meet_it():
    points = [(0.0, 0.0), (0.0, 0.1), (-10.0, 0.1)]
    (left,) = parallel([Segment(start=one, end=other) for one, other in pairwise(points)], 0.3)
    assert left.start == pytest.approx((-0.3, -0.2))
    assert left.end == pytest.approx((-10.0, -0.2))


@given(
    bends=st.lists(st.tuples(st.floats(0.5, 5.0), st.floats(-4.0, 4.0)), min_size=2, max_size=6),
    distance=st.floats(-0.6, 0.6).filter(lambda size: abs(size) > 0.01),
)
def test_a_parallel_is_nowhere_nearer_than_its_distance(bends, distance):
    points = [(0.0, 0.0)]
    for along, across in bends:
        points.append((points[-1][0] + along, points[-1][1] + across))
    contour = [Segment(start=one, end=other) for one, other in pairwise(points)]
    try:
        made = parallel(contour, distance)
    except ValueError:
        return
    for segment in made:
        for point in (segment.start, segment.end):
            assert min(one.distance(point) for one in contour) == pytest.approx(abs(distance), rel=1e-5)


def test_the_distance_of_points_from_lines_and_arcs():
    line, arc = Segment(start=(0, 0), end=(10, 0)), Segment(start=(5, 0), end=(0, 5), centre=(0, 0), sense=1)
    assert [line.distance(point) for point in ((4, -3), (13, 4), (-3, 4))] == [3, 5, 5]
    assert [arc.distance(point) for point in ((3, 4), (6, 8), (5, -2))] == pytest.approx([0, 5, 2])


def test_a_fillet_of_no_length_is_left_out():
    before, after = Segment(start=(-5, 0), end=(0, 0)), Segment(start=(0, 0), end=(5, 0.01))
    one, between, other = rounded(before, after, 0.4, straight=False)
    assert (one, other) == (before, after)
    assert between.is_point


@given(angle=st.floats(0.2, 2.9), radius=st.floats(0.1, 2.0))
def test_a_fillet_touches_both_lines(angle, radius):
    before = Segment(start=(-50, 0), end=(0, 0))
    after = Segment(start=(0, 0), end=(50 * cos(angle), 50 * sin(angle)))
    one, arc, other = rounded(before, after, radius, straight=False)
    assert one.end == arc.start
    assert arc.end == other.start
    assert arc.centre is not None
    reach = radius * abs(sin(angle / 2) / cos(angle / 2))
    assert hypot(*arc.start) == pytest.approx(reach)
    for segment, point in ((before, arc.start), (after, arc.end)):
        assert segment.tangent(point) == pytest.approx(arc.tangent(point), abs=1e-9)


def test_a_chamfer_stands_where_the_fillet_would():
    _, flat, _ = rounded(UP, OVER, 2.0, straight=True)
    assert (flat.start, flat.end, flat.centre) == ((0, pytest.approx(8)), (pytest.approx(2), 10), None)


def test_a_fillet_between_line_and_arc_touches_both():
    line = Segment(start=(-10, 0), end=(0, 0))
    arc = Segment(start=(0, 0), end=(-5, 5), centre=(-5, 0), sense=1)
    _, fillet, _ = rounded(line, arc, 1.0, straight=False)
    assert fillet.centre is not None
    assert fillet.centre == (pytest.approx(-5 + sqrt(15)), pytest.approx(1))
    assert hypot(fillet.end[0] + 5, fillet.end[1]) == pytest.approx(5)


def test_no_fillet_is_greater_than_its_lines():
    with pytest.raises(ValueError, match="no arc"):
        rounded(UP, OVER, 20.0, straight=False)


def test_no_corner_needs_no_fillet():
    on = Segment(start=(0, 10), end=(0, 20))
    before, between, after = rounded(UP, on, 1.0, straight=False)
    assert (before, after) == (UP, on)
    assert between.is_point


@given(st.floats(0.1, 3.0))
def test_a_parallel_keeps_its_distance(distance):
    points = [(0.0, 0.0), (10.0, 0.0), (20.0, 6.0), (30.0, 6.0), (40.0, -3.0), (60.0, -3.0)]
    contour = [Segment(start=a, end=b) for a, b in pairwise(points)]
    for piece in parallel(contour, distance):
        for point in (piece.start, piece.end, _middle(piece)):
            near = min(_away(line, point) for line in contour)
            assert near == pytest.approx(distance)


def _middle(piece: Segment) -> tuple[float, float]:
    if piece.centre is None:
        return (piece.start[0] + piece.end[0]) / 2, (piece.start[1] + piece.end[1]) / 2
    turn = piece.sense * piece.turned(piece.end) / 2
    across, up = piece.start[0] - piece.centre[0], piece.start[1] - piece.centre[1]
    return (piece.centre[0] + across * cos(turn) - up * sin(turn),
            piece.centre[1] + across * sin(turn) + up * cos(turn))  # fmt: skip


def _away(line: Segment, point: tuple[float, float]) -> float:
    size = hypot(line.end[0] - line.start[0], line.end[1] - line.start[1])
    across, up = line.tangent(line.start)
    along = min(max((point[0] - line.start[0]) * across + (point[1] - line.start[1]) * up, 0.0), size)
    return hypot(point[0] - line.start[0] - along * across, point[1] - line.start[1] - along * up)


def test_the_angle_of_an_arc():
    assert ARC.turned(ARC.end) == pytest.approx(pi / 2)
    assert ARC.way_to((0, 5)) == pytest.approx(pi / 2)
