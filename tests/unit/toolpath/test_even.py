"""Even chains under Q: lines stand for the same number of chords each, at the same places wherever reading begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia.machine.load import load
from trochia.program import MOVE, MoveKind, PathMode, Program
from trochia.toolpath import build

MILL = load("reference-mill")
TOLERANCE = 0.01


def chain(points):
    """Feeds through points, G64 P0.01 Q0.01."""
    moves = np.zeros(len(points) - 1, dtype=MOVE)
    moves["target"][:, :2], moves["kind"], moves["rate"] = points[1:], MoveKind.FEED, 100.0
    moves["path_mode"], moves["tolerance"] = PathMode.BLEND, [TOLERANCE, TOLERANCE]
    start = np.zeros(9)
    start[:2] = points[0]
    return Program(name="even", lines=len(moves), start=start, moves=moves, actions=())


def swinging(count, chord=0.2, noise=0.0):
    """Chords of one length whose turn swings between that of 8 mm and of 60 mm radius."""
    way = chord * np.arange(count)
    heading = np.cumsum(chord * (0.07 + 0.055 * np.sin(way / 15.0)))
    points = np.cumsum(chord * np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)
    return points + noise * np.random.default_rng(1).uniform(-1.0, 1.0, points.shape)


def lines(path):
    """Numbers of the moves at whose start a line stands."""
    return np.unique(path.segments["move"])


def test_lines_stand_for_powers_of_two_that_change_rarely():
    path = build(chain(swinging(2000)), MILL, continuity=2)
    starts = lines(path)
    strides = np.diff(starts)[40:-40]
    assert path.merged > 600
    assert set(strides) <= {1, 2, 4, 8, 16}
    assert (starts[40:-41] % strides == 0).all()
    assert (np.diff(strides) != 0).sum() <= len(strides) // 16


def test_noise_on_the_points_makes_q_take_what_it_can():
    noisy, even = (build(chain(swinging(2000, noise=n)), MILL, continuity=2) for n in (1e-3, 0.0))
    assert noisy.merged > even.merged


@pytest.mark.parametrize("first", [100, 333, 641])
def test_a_piece_has_the_lines_of_the_whole(first):
    program = chain(swinging(1200))
    whole = build(program, MILL, continuity=2)
    piece = replace(program, moves=program.moves[first:], start=program.moves["target"][first - 1].copy())
    found = lines(build(piece, MILL, continuity=2, first_row=first)) + first
    assert np.array_equal(found[found > first + 64], lines(whole)[lines(whole) > first + 64])


def test_both_paths_lie_within_the_tolerance_of_each_other():
    points = swinging(600)
    path = build(chain(points), MILL, continuity=2)
    rows = np.repeat(np.arange(len(path)), 9)
    s = np.tile(np.linspace(0.0, 1.0, 9), len(path)) * path.segments["length"][rows]
    commanded = path.points(rows, s)[:, :2]
    assert to_polyline(commanded, points).max() <= TOLERANCE
    assert to_polyline(points, commanded).max() <= TOLERANCE * (1.0 + 1e-3)  # of chords of the commanded path


def to_polyline(points, corners):
    """Distance of points from a polyline (k,)."""
    a, b = corners[:-1], corners[1:]
    step = b - a
    square = np.maximum((step**2).sum(axis=1), 1e-30)
    best = np.full(len(points), np.inf)
    for k in range(len(points)):
        t = np.clip(((points[k] - a) * step).sum(axis=1) / square, 0.0, 1.0)
        best[k] = np.sqrt(((a + t[:, None] * step - points[k]) ** 2).sum(axis=1).min())
    return best
