"""Lathe cycles as moves of a program: they never cut into the part, and leave nothing above the next pass."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import trochia
from trochia.errors import ProgramError
from trochia.languages.gcode import problems
from trochia.program import MoveKind

STEPS = st.lists(st.tuples(st.integers(-3, 4), st.integers(1, 5)), min_size=1, max_size=6)


def _turn(points, cycle):
    drawn = "\n".join(f"G1 X{x} Z{z}" for x, z in points)
    text = f"G18 F100\nO1 SUB\n{drawn}\nO1 ENDSUB\nG0 X50 Z3\n{cycle}\nM2\n"
    return trochia.gcode(text)


def _profile(steps):
    points = [(10, 0)]
    for across, down in steps:
        points.append((max(points[-1][0] + across, 1), points[-1][1] - down))
    return points


@given(steps=STEPS, cycle=st.sampled_from(["G71", "G71.1", "G71.2"]))
def test_no_move_enters_the_part(steps, cycle):
    points = _profile(steps)
    program = _turn(points, f"{cycle} Q1 X40 I1.3")
    z, x = np.array([(-b, a) for a, b in points], dtype=float).T
    way = np.concatenate([program.starts()[1:2], program.moves["target"][1:]])
    for a, b in pairwise(way):
        along = np.linspace(a, b, 21)
        inside = (-along[:, 2] >= z[0]) & (-along[:, 2] <= z[-1])
        if x[-1] >= x[0]:
            assert (along[inside, 0] >= np.interp(-along[inside, 2], z, x) - 1e-9).all()


def test_passes_are_one_depth_apart():
    program = _turn([(10, 0), (10, -20)], "G71 Q1 X40 I4 R0.5")
    moves = program.moves
    cuts = moves["target"][moves["kind"] == MoveKind.FEED][:, 0]
    assert cuts.tolist() == [40, 36, 32, 28, 24, 20, 16, 12, 10, 40]


def test_moves_have_the_line_of_their_cycle():
    program = _turn([(10, 0), (10, -20)], "G70 Q1")
    assert set(program.moves["line"][1:].tolist()) == {7}


def test_the_profile_sees_its_own_position():
    text = (
        "G18 F9\nO1 SUB\nG0 X10 Z0\nO2 REPEAT [3]\nG1 X[#<_x>+1] Z[#<_z>-2]\nO2 ENDREPEAT\nO1 ENDSUB\nG70 Q1 X20 Z2\nM2"
    )
    assert trochia.gcode(text).moves["target"][-1, [0, 2]].tolist() == [13, -6]


def test_what_a_profile_does_not_draw_is_not_done():
    text = "G18 F9\nO1 SUB\nG0 X10 Z0\nM8\nF77\nG1 Z-5\nO1 ENDSUB\nG70 Q1 X20 Z2\nG1 X30\nM2"
    program = trochia.gcode(text)
    assert [action.line for action in program.actions] == [10]
    assert program.moves["rate"][-1] == pytest.approx(9 / 60)


def test_after_a_wrong_cycle_reading_goes_on():
    text = "G18 F9\nG71 X3\nG1 X5\nO1 SUB\nG1 X1 Z1\nG1 X2 Z-1\nG1 X1 Z2\nO1 ENDSUB\nG71 Q1 X9\nG1 X4\nM2\n"
    assert [error.source.line for error in problems(text)] == [2, 8]


def test_a_cycle_in_a_subroutine_runs_its_profile():
    text = "G18 F9\nO1 SUB\nG0 X10 Z0\nG1 Z-5\nO1 ENDSUB\nO2 SUB\nG70 Q1 X20 Z2\nO2 ENDSUB\nO2 CALL\nO2 CALL\nM2"
    assert len(trochia.gcode(text).moves) == 8


def test_a_profile_that_ends_the_text_is_an_error():
    with pytest.raises(ProgramError):
        trochia.gcode("G18 F9\nG70 Q1 X20 Z2\nM2\nO1 SUB\nG0 X10 Z0\n")
