"""Laws of every path: it stays inside the tolerance both ways, joins up, and ends where the program ends."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.program import PathMode
from trochia.toolpath import SegmentKind, build

MACHINES = ["mill", "rotary"]
DENSE = 800


def ends(path, derivative):
    """x or x' at the start and at the end of every segment."""
    rows = np.arange(len(path))
    return path.points(rows, np.zeros(len(path)), derivative), path.points(rows, path.segments["length"], derivative)


@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_segments_join_and_direction_jumps_at_stops_only(motion, name, data):
    machine = motion.machines[name]
    program = data.draw(motion.programs(machine))
    path = build(program, machine)
    if not len(path):
        return
    starts, finishes = ends(path, 0)
    assert np.abs(starts[1:] - finishes[:-1]).max(initial=0) < 1e-9
    assert np.allclose(finishes[-1], program.moves["target"][-1][list(machine.columns)], atol=1e-9)
    before, after = ends(path, 1)[1][:-1], ends(path, 1)[0][1:]
    passing = path.segments["stop"][:-1] == 0
    assert np.abs(before - after)[passing].max(initial=0) <= 1.001e-6 * max(1.0, np.abs(before).max(initial=0))
    assert path.segments["stop"][-1] == 1


@given(data=st.data())
def test_lines_and_arcs_are_measured_by_their_own_length(motion, data):
    machine = motion.machines["mill"]
    path = build(data.draw(motion.programs(machine)), machine)
    curves = np.flatnonzero(path.segments["kind"] != SegmentKind.CUBIC)
    for row in curves:
        s = np.linspace(0, path.segments["length"][row], 50)
        slope = np.linalg.norm(path.points(np.full(50, row), s, 1), axis=1)
        assert np.allclose(slope, 1.0, atol=3e-5)  # 1 % of spiral: (0.01 / 2)² between its ends
        assert slope[[0, -1]] == pytest.approx([1, 1], abs=3e-5)


@given(data=st.data())
def test_extents_hold_every_point_and_are_reached(motion, data):
    machine = motion.machines["mill"]
    path = build(data.draw(motion.programs(machine)), machine)
    least, greatest = path.extents()
    rows = np.repeat(np.arange(len(path)), 400)
    s = np.tile(np.linspace(0, 1, 400), len(path)) * path.segments["length"][rows]
    points = np.concatenate([path.points(rows, s), path.start[None, :]])
    assert (points >= least - 1e-9).all()
    assert (points <= greatest + 1e-9).all()
    # between two samples a curve leaves the greater by at most delta² / 8 times its bend
    bend = np.abs(path.points(rows, s, 2)).max(initial=0) * 1.5
    slack = (path.segments["length"].max(initial=0) / 399) ** 2 / 8 * bend + 1e-9
    assert (points.min(axis=0) <= least + slack).all()
    assert (points.max(axis=0) >= greatest - slack).all()


def polyline_distance(points, line):
    """Distance from each point to the nearest chord of a line."""
    a, b = line[:-1], line[1:]
    along = b - a
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    found = np.full(len(points), np.inf)
    for row, point in enumerate(points):
        u = np.clip(((point - a) * along).sum(axis=1) / square, 0, 1)
        found[row] = np.sqrt((((a + along * u[:, None]) - point) ** 2).sum(axis=1).min())
    return found


def near_joint(path, row, *, backwards, window):
    """Points of the path over ``window`` of s before the end (or after the start) of a segment."""
    length = path.segments["length"][row]
    width = min(window, length)
    s = np.linspace(length - width, length, DENSE) if backwards else np.linspace(0, width, DENSE)
    return path.points(np.full(DENSE, row), s)[:, :3]


@given(data=st.data(), exponent=st.floats(-4, 0))
def test_blends_stay_inside_the_tolerance_both_ways(motion, data, exponent):
    machine, tolerance = motion.machines["mill"], 10**exponent
    program = data.draw(motion.programs(machine, st.just((PathMode.BLEND, tolerance)), most=6))
    program.moves.setflags(write=True)
    program.moves["rate"], program.moves["kind"][program.moves["kind"] == 0] = 50.0, 1  # one blend a joint
    program.moves["law"] = 0
    path, exact = build(program, machine), build(program, machine, blend=False)
    for row in np.flatnonzero(path.segments["kind"] == SegmentKind.CUBIC):
        window = path.segments["length"][row]
        entered = int(np.flatnonzero(exact.segments["move"] == path.segments["move"][row])[0])
        programmed = np.concatenate(
            [
                near_joint(exact, entered - 1, backwards=True, window=window),
                near_joint(exact, entered, backwards=False, window=window),
            ]
        )
        commanded = path.points(np.full(DENSE, row), np.linspace(0, window, DENSE))[:, :3]
        assert polyline_distance(commanded[::15], programmed).max() <= tolerance * (1 + 1e-5)
        around = [commanded]
        if row > 0:
            around.insert(0, near_joint(path, row - 1, backwards=True, window=window))
        if row + 1 < len(path):
            around.append(near_joint(path, row + 1, backwards=False, window=window))
        # what the joints before and after take of the same move is theirs to answer for
        near = programmed[DENSE // 2 : -DENSE // 2 : 15]
        assert polyline_distance(near, np.concatenate(around)).max() <= tolerance * (1 + 1e-5)


@given(data=st.data())
def test_exact_stop_reaches_every_corner(motion, data):
    machine = motion.machines["mill"]
    program = data.draw(motion.programs(machine, st.just((PathMode.EXACT_STOP, 0.0))))
    path = build(program, machine)
    assert (path.segments["stop"] == 1).all()
    if len(path):
        reached = ends(path, 0)[1]
        assert np.allclose(reached, program.moves["target"][path.segments["move"]][:, :3], atol=1e-9)
