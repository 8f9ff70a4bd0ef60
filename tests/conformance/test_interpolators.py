"""What every interpolator promises, over the registry: exact end, bounded deviation, one step a tick, symmetry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.interpolate import METHODS
from trochia.pulses.interpolators import INTERPOLATORS, Arc, Figure, Interpolator, Line, positions
from trochia.pulses.interpolators.compare import deviations, end_of, start_of

pytestmark = pytest.mark.parametrize("method", INTERPOLATORS.values(), ids=lambda method: method.name)
COORDINATES = st.integers(-400, 400)


@st.composite
def arcs(draw: st.DrawFn) -> Arc:
    """Arcs of any radius (its square whole), from anywhere to anywhere, either way."""
    squared = draw(st.one_of(st.integers(1, 400), st.integers(1, 500).map(lambda r: r * r), st.integers(1, 250_000)))
    radius = math.sqrt(squared)
    ends = [
        (round(radius * math.cos(angle)), round(radius * math.sin(angle)))
        for angle in (draw(st.floats(0, 2 * math.pi)), draw(st.floats(0, 2 * math.pi)))
    ]
    return Arc(start=ends[0], end=ends[1], radius_squared=squared, clockwise=draw(st.booleans()))


LINES = st.builds(Line, x=COORDINATES, y=COORDINATES).filter(lambda line: line.length > 0)
FIGURES = st.one_of(LINES, arcs())


def track(method: Interpolator, figure: Figure) -> np.ndarray:
    return positions(method.pulses(figure), start_of(figure))


def test_is_known_to_the_core(method: Interpolator) -> None:
    assert method.name in METHODS


@given(figure=FIGURES)
def test_ends_exactly_at_the_end_point(method: Interpolator, figure: Figure) -> None:
    assert tuple(track(method, figure)[-1]) == end_of(figure)


@given(figure=FIGURES)
def test_stays_within_its_deviation(method: Interpolator, figure: Figure) -> None:
    bound = method.line_bound if isinstance(figure, Line) else method.arc_bound
    assert np.abs(deviations(figure, track(method, figure))).max() <= bound


@given(figure=FIGURES)
def test_core_equals_its_statement_in_python(method: Interpolator, figure: Figure) -> None:
    assert method.pulses(figure).tolist() == method.reference(figure).tolist()


@given(figure=FIGURES)
def test_makes_no_step_in_vain(method: Interpolator, figure: Figure) -> None:
    """At most one step an axis a tick; empty ticks no more than a half-used register's, or a slow law's on a circle."""
    points = track(method, figure)
    assert np.abs(np.diff(points, axis=0)).max() == 1
    steps = int(np.abs(np.diff(points, axis=0)).sum())
    if isinstance(figure, Line):
        assert steps == abs(figure.x) + abs(figure.y)
        assert len(points) - 1 <= 2 * steps
    else:
        assert len(points) - 1 <= 2 * steps + 2 * math.pi * 64


@given(line=LINES)
def test_lines_are_monotone(method: Interpolator, line: Line) -> None:
    moves = np.diff(track(method, line), axis=0)
    assert (moves[:, 0] * np.sign(line.x) >= 0).all()
    assert (moves[:, 1] * np.sign(line.y) >= 0).all()


@given(arc=arcs())
def test_arcs_are_monotone_in_each_quadrant(method: Interpolator, arc: Arc) -> None:
    """Turning as asked: the moves never go against the tangent's signs."""
    points = track(method, arc)
    moves, way = np.diff(points, axis=0), -1 if arc.clockwise else 1
    x, y = points[:-1].T
    assert (moves[:, 0] * way * -np.sign(y) >= 0)[y != 0].all()
    assert (moves[:, 1] * way * np.sign(x) >= 0)[x != 0].all()


@given(line=LINES)
def test_lines_are_symmetric_over_quadrants(method: Interpolator, line: Line) -> None:
    first = track(method, Line(x=abs(line.x), y=abs(line.y)))
    assert (track(method, line) == first * [np.sign(line.x) or 1, np.sign(line.y) or 1]).all()


@given(line=LINES)
def test_lines_are_symmetric_over_octants(method: Interpolator, line: Line) -> None:
    """Swapping the axes swaps the track; the point-by-point method alone prefers X, on the line and on the diagonal."""
    if method.name == "point":
        there = np.sort(np.abs(deviations(line, track(method, line)))).max()
        back = Line(x=line.y, y=line.x)
        assert abs(there - np.abs(deviations(back, track(method, back))).max()) <= 1
    else:
        assert (track(method, Line(x=line.y, y=line.x)) == track(method, line)[:, ::-1]).all()


@given(arc=arcs(), quarters=st.integers(1, 3))
def test_arcs_are_symmetric_over_quadrants(method: Interpolator, arc: Arc, quarters: int) -> None:
    turn = np.array([[1, 0], [0, 1]])
    for _ in range(quarters):
        turn = np.array([[0, -1], [1, 0]]) @ turn
    ends = [tuple(int(v) for v in turn @ point) for point in (arc.start, arc.end)]
    turned = Arc(start=ends[0], end=ends[1], radius_squared=arc.radius_squared, clockwise=arc.clockwise)
    assert (track(method, turned) == track(method, arc) @ turn.T).all()


@given(arc=arcs())
def test_arcs_are_symmetric_over_both_ways(method: Interpolator, arc: Arc) -> None:
    mirrored = Arc(start=arc.start[::-1], end=arc.end[::-1], radius_squared=arc.radius_squared,
                   clockwise=not arc.clockwise)  # fmt: skip
    assert (track(method, mirrored) == track(method, arc)[:, ::-1]).all()


@pytest.mark.parametrize("radius", [1, 2, 3, 5, 100, 1023, 1024])
def test_whole_circles_come_back(method: Interpolator, radius: int) -> None:
    points = track(method, Arc(start=(0, radius), end=(0, radius), radius_squared=radius * radius))
    assert tuple(points[-1]) == (0, radius)
    assert points.min() == -radius
    assert points.max() == radius
    assert np.abs(np.diff(points, axis=0)).sum() == 8 * radius
