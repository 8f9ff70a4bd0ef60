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


def test_a_spline_is_the_curve_itself():
    program = read("F600\nG5 X10 Y0 I0 J5 P0 Q5")
    assert program.moves["kind"].tolist() == [MoveKind.SPLINE]
    assert program.splines[0].tolist() == [[0, 0, 0], [0, 5, 0], [10, 5, 0], [10, 0, 0]]
    assert program.moves["target"][0, :2].tolist() == [10, 0]


def test_a_spline_lies_where_its_system_does():
    program = read("F600\nG10 L2 P1 X5 Y1 Z2 R90\nG92 Z1\nG20\nG0 X0 Y0 Z1\nG5.1 X2 I1 J1")
    # turned by 90 degrees: (x, y) of the program is (-y, x); then the origin
    quadratic = np.array([(0, 0), (25.4, 25.4), (50.8, 0)])
    cubic = np.array([quadratic[0], (quadratic[0] + 2 * quadratic[1]) / 3, (2 * quadratic[1] + quadratic[2]) / 3,
                      quadratic[2]])  # fmt: skip
    assert program.splines[0, :, 0] == pytest.approx(5 - cubic[:, 1])
    assert program.splines[0, :, 1] == pytest.approx(1 + cubic[:, 0])
    assert program.splines[0, :, 2] == pytest.approx(program.moves["target"][-1, 2])
    assert program.splines[0, -1] == pytest.approx(program.moves["target"][-1, :3])


def test_a_rational_curve_is_cubics_near_it():
    quarter = "F60\nG0 X10\nG5.2 P1 L3\nX10 Y10 P0.70710678118654752\nX0 Y10 P1\nG5.3"
    program = read(quarter)
    t = np.linspace(0, 1, 50)[:, None, None]
    p = program.splines.transpose(1, 0, 2)[:, None]
    points = (1 - t) ** 3 * p[0] + 3 * (1 - t) ** 2 * t * p[1] + 3 * (1 - t) * t**2 * p[2] + t**3 * p[3]
    assert np.abs(np.hypot(points[..., 0], points[..., 1]) - 10).max() <= 1e-4
    assert set(program.moves["kind"].tolist()) == {MoveKind.RAPID, MoveKind.SPLINE}


def test_a_spline_in_inverse_time_lasts_what_it_was_given():
    moves = read("G93 G5.1 X10 I5 J5 F2").moves
    assert (1 / moves["rate"]).sum() == pytest.approx(30.0)


def test_a_curve_in_another_plane_lies_in_xy():
    program = read("F60\nG18\nG5.2 P1 L3\nX5 Y5 P1\nX10 Y0 P1\nG5.3")
    assert program.splines[-1, -1].tolist() == [10, 0, 0]
    assert (program.splines[..., 2] == 0).all()


def test_travel_is_checked_along_the_curve_not_only_at_its_end():
    mill = load("reference-mill")
    text = "S99 M3 F600\nG0 X-480\nG5 X-470 Y0 I-60 J50 P-60 Q50\nM2\n"
    first = trochia.check(text, mill).problems[0]
    assert (first.code, first.line) == ("travel", 3)


def test_extents_and_time_are_those_of_the_curve():
    plan = trochia.plan(read("S99 M3 F600\nG5 X10 Y0 I0 J10 P0 Q10"), load("reference-mill"))
    assert plan.size.extents[1, 1] == pytest.approx(7.5, abs=1e-3)  # 10 * 3 t (1 - t) at a half
    assert plan.size.feed_length == pytest.approx(20.0, abs=5e-3)
    recording = trochia.simulate(plan)
    assert recording is not None


def test_a_curve_that_leads_nowhere_is_no_move():
    assert len(read("F60\nG5.2 P1 L3\nX0 Y0 P1\nX0 Y0 P1\nG5.3").moves) == 0


@pytest.mark.parametrize("code", ["G87 X1 Z-1 R1 I1 J0 K0", "G88 X1 Z-1 R1 P0"])
def test_check_warns_of_what_is_not_done(code):
    text = f"S100 M3 F60\n{code}\nM2\n"
    assert [action.code for action in of(trochia.gcode(text), Unfinished)] == [code[:3]]
    problems = trochia.check(text, load("reference-mill")).problems
    assert [problem.line for problem in problems if problem.code == "unfinished-code"] == [2]


def test_diameters_are_halved():
    program = read("G7 G0 X10\nG91 G0 X4\nG8 G90 G0 X4")
    assert program.moves["target"][:, 0].tolist() == [5, 7, 4]
