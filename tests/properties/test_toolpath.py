"""Laws of every path: it stays inside the tolerance both ways, joins up, and ends where the program ends."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.program import MOVE, PathMode, Program
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


def reach(path, row, window, step):
    """Pieces of the path after (or, for step -1, before) a segment, in its order, that cover ``window``."""
    pieces = []
    while window > 0 and 0 <= row + step < len(path):
        row += step
        pieces.append(near_joint(path, row, backwards=step < 0, window=window))
        window -= path.segments["length"][row]
    return pieces[::step]


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
        around = np.concatenate([*reach(path, row, window, -1), commanded, *reach(path, row, window, 1)])
        # what the joints before and after take of the same move is theirs to answer for
        near = programmed[DENSE // 2 : -DENSE // 2 : 15]
        assert polyline_distance(near, around).max() <= tolerance * (1 + 1e-5)


def dense(path, least=4000):
    """Points along a whole path, and how far a curve may leave the chords between them."""
    each = max(40, least // len(path))
    rows = np.repeat(np.arange(len(path)), each)
    length = path.segments["length"]
    points = path.points(rows, np.tile(np.linspace(0, 1, each), len(path)) * length[rows])[:, :3]
    every = np.arange(len(path))
    bend = np.max([np.linalg.norm(path.points(every, length * u, 2), axis=1) for u in (0.0, 0.5, 1.0)], axis=0)
    return points, float((1.2 * bend * (length / (each - 1)) ** 2 / 8).max())


def jumps(path, derivative, *, overlap=False):
    """Jumps of a derivative where motion passes; with ``overlap`` those of x'' across x'."""
    starts, finishes = ends(path, derivative)
    apart = (starts[1:] - finishes[:-1])[path.segments["stop"][:-1] == 0]
    if overlap and derivative == 2:
        along = ends(path, 1)[0][1:][path.segments["stop"][:-1] == 0]
        apart = apart - along * ((apart * along).sum(axis=1) / (along * along).sum(axis=1))[:, None]
    return np.abs(apart).max(initial=0), max(1.0, np.abs(starts).max()) if derivative else 1.0


@pytest.mark.parametrize("overlap", [False, True])
@pytest.mark.parametrize("name", MACHINES)
@given(data=st.data())
def test_curvature_jumps_at_stops_only(motion, name, overlap, data):
    machine = motion.machines[name]
    program = data.draw(motion.programs(machine))
    path = build(program, machine, continuity=2, overlap=overlap)
    if not len(path):
        return
    for derivative, allowed in ((0, 1e-9), (1, 1e-6), (2, 1e-6)):
        jump, scale = jumps(path, derivative, overlap=overlap)
        assert jump <= 1.001 * allowed * scale
    assert np.allclose(ends(path, 0)[1][-1], program.moves["target"][-1][list(machine.columns)], atol=1e-9)
    assert (np.diff(path.segments["move"].astype(int)) >= 0).all()


@st.composite
def chains(draw):
    """Chords as files have them: even or uneven, smooth, rounded to a grid, or turning anyhow."""
    chance = np.random.default_rng(draw(st.integers(0, 2**16)))
    count, size = draw(st.integers(2, 60)), 10 ** chance.uniform(-2, 1)
    turns = chance.choice([0.005, 0.05, 0.5, 3.0]) * chance.uniform(-1, 1, count)
    if chance.uniform() < 0.5:
        turns[:] = turns[0]
    lengths = size * 10 ** (chance.choice([0.0, 1e-5, 0.2, 1.0]) * chance.uniform(-0.5, 0.5, count))
    heading = np.cumsum(turns)
    steps = lengths[:, None] * np.stack(
        [np.cos(heading), np.sin(heading), chance.choice([0, 0.3]) * np.sin(heading)], 1
    )
    return np.round(np.cumsum(steps, axis=0), int(draw(st.sampled_from([3, 4, 12]))))


def program_through(points, tolerance):
    moves = np.zeros(len(points), dtype=MOVE)
    moves["target"][:, :3], moves["kind"], moves["rate"] = points, 1, 50.0
    moves["path_mode"], moves["tolerance"] = PathMode.BLEND, tolerance
    return Program(name="chain", lines=len(points), start=np.zeros(9), moves=moves, actions=())


def assert_near(program, machine, tolerance, *, overlap=False):
    path, exact = build(program, machine, continuity=2, overlap=overlap), build(program, machine, blend=False)
    if not len(path):
        return
    (commanded, slack), (programmed, other) = dense(path), dense(exact)
    allowed = tolerance * (1 + 1e-9) + slack + other + 1e-12
    assert polyline_distance(commanded[::23], programmed).max() <= allowed
    assert polyline_distance(programmed[::23], commanded).max() <= allowed


@given(points=chains(), exponent=st.floats(-4, 0), overlap=st.booleans())
def test_chains_stay_inside_the_tolerance_both_ways_and_are_smooth(motion, points, exponent, overlap):
    program = program_through(points, 10**exponent)
    machine = motion.machines["mill"]
    assert_near(program, machine, 10**exponent, overlap=overlap)
    path = build(program, machine, continuity=2, overlap=overlap)
    if not len(path):
        return
    for derivative in (1, 2):
        jump, scale = jumps(path, derivative, overlap=overlap)
        assert jump <= 1.1e-9 * scale


@given(data=st.data(), exponent=st.floats(-4, 0), overlap=st.booleans())
def test_smooth_joints_of_arcs_stay_inside_the_tolerance_both_ways(motion, data, exponent, overlap):
    program = data.draw(motion.programs(motion.machines["mill"], st.just((PathMode.BLEND, 10**exponent)), most=6))
    assert_near(program, motion.machines["mill"], 10**exponent, overlap=overlap)


@given(data=st.data())
def test_exact_stop_reaches_every_corner(motion, data):
    machine = motion.machines["mill"]
    program = data.draw(motion.programs(machine, st.just((PathMode.EXACT_STOP, 0.0))))
    path = build(program, machine)
    assert (path.segments["stop"] == 1).all()
    if len(path):
        reached = ends(path, 0)[1]
        assert np.allclose(reached, program.moves["target"][path.segments["move"]][:, :3], atol=1e-9)
