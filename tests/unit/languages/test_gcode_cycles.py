"""What cycles, threads, probes and splines become in a program: rows, laws of time, actions."""

from __future__ import annotations

import numpy as np
import pytest

import trochia
from trochia.machine.load import load
from trochia.program import (
    MoveKind,
    PathMode,
    Probe,
    SpindleLock,
    TimeLaw,
    Unfinished,
)


def read(text):
    return trochia.gcode(text + "\nM2\n")


def of(program, kind):
    return [action for action in program.actions if isinstance(action, kind)]


def test_a_hole_is_rapids_and_a_feed_in_exact_path_mode():
    program = read("F60\nG64 P0.1\nG0 Z5\nG98 G81 X1 Z-1 R1\nG1 X2")
    kinds = [MoveKind.RAPID, MoveKind.RAPID, MoveKind.RAPID, MoveKind.FEED, MoveKind.RAPID, MoveKind.FEED]
    assert program.moves["kind"].tolist() == kinds
    assert program.moves["target"][1:5, 2].tolist() == [5, 1, -1, 5]
    modes = program.moves["path_mode"].tolist()
    assert modes == [PathMode.BLEND, *[PathMode.EXACT_PATH] * 4, PathMode.BLEND]
    assert program.moves["tolerance"][5, 0] == pytest.approx(0.1)


def test_path_mode_comes_back_in_its_own_unit():
    program = read("F60\nG64 P0.1\nG20\nG81 X1 Z-1 R1\nG1 X2")
    assert program.moves["tolerance"][-1, 0] == pytest.approx(0.1)


def test_a_thread_is_fed_by_the_turn():
    program = read("S300 M3 F60\nG33 Z-10 K1.5\nG1 X1")
    assert program.moves["law"].tolist() == [TimeLaw.PER_REV, TimeLaw.PER_SECOND]
    assert program.moves["rate"].tolist() == [1.5, 1.0]
    assert [(lock.at, lock.pitch) for lock in of(program, SpindleLock)] == [(0, 1.5), (1, 0.0)]


def test_a_thread_lasts_its_turns():
    plan = trochia.plan(read("S300 M3\nG33 Z-100 K1.5"), load("reference-mill"))
    turns = 100 / 1.5 / (300 / 60)
    assert plan.time_s == pytest.approx(turns + 7.5 / 400, abs=0.5)
    assert plan.time_s >= turns


def test_an_inch_thread_is_converted():
    program = read("S300 M3\nG20\nG33 Z-1 K0.1")
    assert program.moves["rate"][0] == pytest.approx(2.54)


def test_a_rigid_tap_comes_back():
    program = read("S100 M3\nG0 Z2\nG33.1 Z-6 K0.8 I2\nG0 Z3")
    assert program.moves["target"][:, 2].tolist() == [2, -6, 2, 3]
    turns = [(a.direction, a.speed) for a in program.actions if type(a).__name__ == "Spindle"]
    assert turns[:3] == [(1, 100.0), (-1, 200.0), (1, 100.0)]


def test_a_probe_is_a_feed_that_stops():
    program = read("F60\nG38.3 Z-5\nG1 X1")
    assert [(probe.at, probe.toward, probe.must) for probe in of(program, Probe)] == [(0, True, False)]
    assert program.moves["path_mode"].tolist() == [PathMode.EXACT_STOP, PathMode.BLEND_DEFAULT]


def test_a_spline_is_arcs_that_touch():
    program = read("F600\nG5 X10 Y0 I0 J5 P0 Q5")
    moves = program.moves
    assert set(moves["kind"].tolist()) <= {MoveKind.ARC, MoveKind.FEED}
    assert np.allclose(moves["target"][-1, :2], [10, 0], atol=0)
    u = np.linspace(0, 1, 2001)
    y = 3 * u * (1 - u) ** 2 * 5 + 3 * u**2 * (1 - u) * 5
    assert moves["target"][:, 1].max() == pytest.approx(y.max(), abs=2e-3)


def test_a_spline_in_inverse_time_lasts_what_it_was_given():
    moves = read("G93 G5.1 X10 I5 J5 F2").moves
    assert (1 / moves["rate"]).sum() == pytest.approx(30.0)


def test_a_curve_in_another_plane_lies_in_xy():
    moves = read("F60\nG18\nG5.2 P1 L3\nX5 Y5 P1\nX10 Y0 P1\nG5.3").moves
    assert (moves["plane"][moves["kind"] == MoveKind.ARC] == 0).all()
    assert moves["target"][-1, :2].tolist() == [10, 0]


@pytest.mark.parametrize("code", ["G87 X1 Z-1 R1 I1 J0 K0", "G88 X1 Z-1 R1 P0"])
def test_check_warns_of_what_is_not_done(code):
    text = f"S100 M3 F60\n{code}\nM2\n"
    assert [action.code for action in of(trochia.gcode(text), Unfinished)] == [code[:3]]
    problems = trochia.check(text, load("reference-mill")).problems
    assert [problem.line for problem in problems if problem.code == "unfinished-code"] == [2]


def test_diameters_are_halved():
    program = read("G7 G0 X10\nG91 G0 X4\nG8 G90 G0 X4")
    assert program.moves["target"][:, 0].tolist() == [5, 7, 4]
