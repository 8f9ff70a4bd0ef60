"""Sections of a path between two stops: the quicker of passing their corners and stopping at them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import PROFILES, corners, path_of, plan
from trochia.toolpath import build

MILL = load("rotary-mill")
MILL = dataclasses.replace(
    MILL, axes=tuple(dataclasses.replace(axis, jerk=axis.jerk or 20 * axis.acceleration) for axis in MILL.axes)
)
S_CURVE = PROFILES["s-curve"]
#: found by trying: the rotary axis turns back in so short a move that passing the corner is slower than a stop there
SLOWER = "G1 X0.1801 A0.589 F6617\nX0.3601 A-7.001\n"
QUICKER = "G1 X10 Y10 F3000\nX20 Y5\nX10 Y0\n"


def read(text):
    return gcode.read(f"G64 P0.6051\n{text}M2\n")


def seconds(path, program):
    return plan(path, MILL, program=program, profile="s-curve").duration


def stops(path):
    return int(path.segments["stop"][:-1].sum())


def test_the_quicker_form_is_taken():
    program = read(SLOWER)
    blended, exact = build(program, MILL, continuity=2), build(program, MILL, blend=False)
    assert seconds(blended, program) > seconds(exact, program) * 1.001
    path = path_of(program, MILL, S_CURVE)
    assert stops(blended) == 0
    assert stops(path) == 1
    assert seconds(path, program) == pytest.approx(seconds(exact, program), rel=1e-12)


def test_what_is_quicker_passed_stays_as_it_is():
    program = read(QUICKER)
    path, blended = path_of(program, MILL, S_CURVE), build(program, MILL, continuity=2)
    assert (path.segments == blended.segments).all()
    assert seconds(path, program) < seconds(build(program, MILL, blend=False), program)


def test_sections_are_weighed_one_by_one():
    program = read(f"{QUICKER}G4 P0.5\nG91\nG1 X0.1801 A0.589 F6617\nX0.1801 A-7.59\nG4 P0.5\nG90\n{QUICKER}")
    path, blended = path_of(program, MILL, S_CURVE), build(program, MILL, continuity=2)
    assert stops(path) == stops(blended) + 1
    kept, same = (
        rows[~np.isin(rows["move"], [3, 4])][["length", "kind", "stop"]]  # all but the two that are slow
        for rows in (path.segments, blended.segments)
    )
    assert (kept == same).all()


def test_exact_moves_have_nothing_to_weigh(monkeypatch):
    monkeypatch.setattr(corners, "_times", None)  # not asked
    program = gcode.read(f"G61\n{SLOWER}G61.1\n{QUICKER}M2\n")
    assert stops(path_of(program, MILL, S_CURVE)) == 4


def test_long_sections_are_left_alone(monkeypatch):
    program = read(SLOWER)
    monkeypatch.setattr(corners, "MOST", 1)
    assert stops(path_of(program, MILL, S_CURVE)) == 0


def test_an_empty_program_has_an_empty_path():
    assert len(path_of(gcode.read("M2\n"), MILL, S_CURVE)) == 0


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_a_section_takes_the_time_it_takes_in_the_plan(profile):
    """The times that sections are weighed by add up to the whole plan's."""
    program = read(f"{QUICKER}G4 P0.5\n{SLOWER}M5\nG1 X30 Y30 F3000\nX40\nY0\n")
    path = path_of(program, MILL, PROFILES[profile])
    limits = corners.Limits.of(MILL, motors=PROFILES[profile].by_curves)
    firsts, bounds = corners._sections(path, len(program.moves))
    owner = np.repeat(range(len(firsts)), np.diff([*firsts, len(path)]))
    times = corners._times(path, owner, PROFILES[profile], limits)
    assert len(times) + 1 == len(bounds)
    assert times.sum() == pytest.approx(plan(path, MILL, program=program, profile=profile).times["motion"], rel=1e-12)
