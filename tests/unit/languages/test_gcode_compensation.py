"""Cutter compensation: where the tool's centre runs, and what it keeps at a distance."""

from __future__ import annotations

from math import hypot, pi, sqrt

import numpy as np
import pytest

from trochia.errors import ModalConflictError
from trochia.languages import gcode
from trochia.languages.gcode import corners
from trochia.languages.gcode.corners import Circle
from trochia.program import Dwell, MoveKind

HEAD = "F600\nG41.1 D4\nG1 X10\n"


def moves(text: str):
    return gcode.read(text + "M2\n").moves


def test_a_square_is_followed_at_the_radius_with_arcs_about_its_corners():
    found = moves("F600 G0 X-20 Y-20\nG41.1 D6 G1 X0 Y0\nY40\nX40\nY0\nX0\nG40 G0 X-20\n")
    arcs = found[found["kind"] == MoveKind.ARC]
    assert [tuple(centre) for centre in arcs["centre"]] == [(0, 40), (40, 40), (40, 0)]
    assert np.allclose(arcs["target"][:, :2], [(0, 43), (43, 40), (40, -3)])
    assert set(arcs["turns"]) == {-1}


def test_an_inside_corner_ends_both_moves_on_its_bisector():
    found = moves("F600\nG42.1 D4 G1 X10\nX20\nY20\nX30\nG40\n")
    assert tuple(found["target"][1, :2]) == pytest.approx((20, -2))
    inside = moves("F600\nG41.1 D4 G1 X10\nX20\nY20\nG40\n")
    assert tuple(inside["target"][1, :2]) == pytest.approx((18, 2))


def test_the_entry_ends_at_the_radius_beside_its_end():
    found = moves(HEAD)
    assert tuple(found["target"][0, :3]) == pytest.approx((10, 2, 0))


def test_the_way_out_begins_at_the_centre_and_ends_as_programmed():
    found = moves(HEAD + "X20\nG40 G1 X30 Y5\n")
    assert tuple(found["target"][1, :2]) == pytest.approx((20, 2))
    assert tuple(found["target"][2, :2]) == pytest.approx((30, 5))


def test_incremental_moves_count_from_the_programmed_point():
    absolute = moves(HEAD + "X20 Y5\nX40 Y5\nG40 G0 X50\n")
    steps = moves("F600\nG41.1 D4\nG91 G1 X10\nX10 Y5\nX20\nG40 G0 X10\n")
    assert np.allclose(absolute["target"], steps["target"], atol=1e-12)


def test_moves_keep_their_source_lines_while_they_wait():
    program = gcode.read(HEAD + "G4 P1\nZ-1\nY20\nG40\nM2\n")
    assert list(program.moves["line"]) == [3, 5, 6]
    assert [(action.line, action.at) for action in program.actions if isinstance(action, Dwell)] == [(4, 1)]


def test_units_changed_on_the_way_change_the_path_only_by_rounding():
    metric = moves(HEAD + "X20\nY30\nX0\nG40\n")
    mixed = moves(HEAD + f"G20 X{20 / 25.4:.12f}\nY{30 / 25.4:.12f}\nG21 X0\nG40\n")
    assert np.allclose(metric["target"], mixed["target"], atol=1e-9)


@pytest.mark.parametrize("text", ["Y1\nX0\n", "G3 Y3 J1.5\n", "G3 X10 Y10 J5\nG1 Y9\nG40\n"])
def test_what_the_tool_cannot_do_is_refused(text):
    with pytest.raises(ModalConflictError, match="tool"):
        moves(HEAD + text)


def test_a_lathe_tool_may_not_enter_by_an_arc():
    with pytest.raises(ModalConflictError, match="by a line"):
        moves("F60 G18\nG41.1 D2 L3\nG2 X5 Z5 I5\n")


def test_reading_goes_on_behind_a_move_that_gouges():
    problems = gcode.problems(HEAD + "Y1\nX0\nG40\nG0 X0 Y0 Q1\nM2\n")
    assert [error.source.line for error in problems if error.source] == [5, 7]


# --- plane geometry


def test_bend_is_positive_away_from_the_tool_and_negative_towards_it():
    assert corners.bend((0, 1), (1, 0), +1) == pytest.approx(pi / 2)
    assert corners.bend((0, 1), (-1, 0), +1) == pytest.approx(-pi / 2)
    assert corners.bend((0, -1), (1, 0), -1) == pytest.approx(pi / 2)


def test_circles_meet_where_both_radii_reach():
    old = Circle((0.0, 0.0), 5.0, 1, inside=True)
    for inside in (True, False):
        point = corners.circle_to_circle(old, Circle((6.0, 1.0), 4.0, -1, inside=inside))
        assert point is not None
        assert hypot(*point) == pytest.approx(5)
        assert hypot(point[0] - 6, point[1] - 1) == pytest.approx(4)


def test_circles_too_far_apart_or_about_one_centre_do_not_meet():
    old = Circle((0.0, 0.0), 5.0, 1, inside=True)
    assert corners.circle_to_circle(old, Circle((20.0, 0.0), 4.0, 1, inside=True)) is None
    assert corners.circle_to_circle(old, Circle((0.0, 0.0), 4.0, 1, inside=True)) is None


def test_a_line_cuts_a_circle_before_and_behind_its_middle():
    circle = Circle((0.0, 1.0), 2.0, 1, inside=True)
    near = corners.line_to_circle((-9.0, 0.0), (1.0, 0.0), circle, ahead=False)
    far = corners.line_to_circle((-9.0, 0.0), (1.0, 0.0), circle, ahead=True)
    assert near == pytest.approx((-sqrt(3), 0))
    assert far == pytest.approx((sqrt(3), 0))
    assert corners.line_to_circle((-9.0, -3.0), (1.0, 0.0), circle, ahead=True) is None


def test_an_entry_arc_ends_along_its_normal():
    centre = corners.entry_centre((0.0, 0.0), (5.0, 6.0), (0.0, -1.0))
    assert centre is not None
    assert centre[0] == 5.0
    assert hypot(*centre) == pytest.approx(hypot(centre[0] - 5, centre[1] - 6))
    assert corners.entry_centre((0.0, 6.0), (5.0, 6.0), (0.0, -1.0)) is None
