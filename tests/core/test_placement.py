"""Rows into machine coordinates: the C core against the interpreter's own frames."""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.gcode import COMMENT_ROW, FEED_ROW, SPEED_ROW
from trochia.kernels.layout import MOVE
from trochia.kernels.placement import new_placement, place
from trochia.languages.gcode.frames import to_machine
from trochia.languages.gcode.state import State
from trochia.program import MoveKind, Plane, TimeLaw

INCH = 25.4
LENGTHS = st.floats(-1e4, 1e4).map(lambda x: round(x, 4))
NINE = st.lists(LENGTHS, min_size=9, max_size=9)


def rows_of(count: int, **columns: object) -> np.ndarray:
    rows = np.zeros(count, dtype=MOVE)
    for name, values in columns.items():
        rows[name] = values
    return rows


def placed(rows: np.ndarray, **fields: object) -> tuple[np.ndarray, object]:
    """Return the moves of rows, and the placement after them."""
    placement, out = new_placement(), np.empty(len(rows), dtype=MOVE)
    for name, value in fields.items():
        setattr(placement, name, value)
    return out[: place(rows, placement, out)], placement


@given(st.lists(NINE, min_size=1, max_size=5), NINE, NINE, st.floats(-360, 360), st.booleans())
def test_targets_are_those_of_the_frames(points, origin, shift, degrees, inch) -> None:
    state = State(origin=origin, shift=shift, rotation=degrees, inch=inch)
    moves, placement = placed(
        rows_of(len(points), kind=MoveKind.FEED, target=points),
        origin=origin, shift=shift, scale=state.scale, cosine=cos(radians(degrees)), sine=sin(radians(degrees)),
    )  # fmt: skip
    expected = [to_machine(state, point) for point in points]
    np.testing.assert_allclose(moves["target"], expected, rtol=1e-13, atol=1e-8)
    assert list(placement.position) == list(moves["target"][-1])


@pytest.mark.parametrize("plane", Plane)
@given(centre=st.tuples(LENGTHS, LENGTHS), origin=NINE, shift=NINE, degrees=st.sampled_from([0.0, 30.0, -90.0]))
def test_a_centre_goes_where_a_target_there_would_go(centre, origin, shift, degrees, plane) -> None:
    degrees = degrees if plane == Plane.XY else 0.0
    target = np.zeros(9)
    target[list(plane.axes)] = centre
    moves, _ = placed(
        rows_of(1, kind=MoveKind.ARC, target=target, centre=centre, turns=-2, line=7, power=0.5),
        origin=origin, shift=shift, scale=INCH, plane=plane, cosine=cos(radians(degrees)), sine=sin(radians(degrees)),
    )  # fmt: skip
    np.testing.assert_allclose(moves[0]["centre"], moves[0]["target"][list(plane.axes)], rtol=1e-13, atol=1e-8)
    assert (moves[0]["turns"], moves[0]["line"], moves[0]["plane"], moves[0]["power"]) == (-2, 7, plane, 0.5)


def test_a_line_has_no_centre() -> None:
    moves, _ = placed(rows_of(1, kind=MoveKind.FEED), origin=[1.0] * 9)
    assert list(moves[0]["centre"]) == [0.0, 0.0]


@pytest.mark.parametrize(
    ("law", "target", "kind", "rate"),
    [
        (TimeLaw.PER_SECOND, {0: 1.0}, MoveKind.FEED, 600 * INCH / 60),
        (TimeLaw.PER_SECOND, {0: 1.0, 3: 1.0}, MoveKind.FEED, 600 * INCH / 60),
        (TimeLaw.PER_SECOND, {4: 1.0}, MoveKind.FEED, 10.0),  # degree/s
        (TimeLaw.PER_SECOND, {4: 1.0}, MoveKind.ARC, 600 * INCH / 60),
        (TimeLaw.PER_SECOND, {}, MoveKind.FEED, 600 * INCH / 60),
        (TimeLaw.PER_REV, {0: 1.0}, MoveKind.FEED, 600 * INCH),
        (TimeLaw.PER_REV, {5: 1.0}, MoveKind.FEED, 600.0),
        (TimeLaw.INVERSE, {0: 1.0}, MoveKind.FEED, 10.0),
        (TimeLaw.PER_SECOND, {0: 1.0}, MoveKind.RAPID, 0.0),
    ],
)
def test_rates(law, target, kind, rate) -> None:
    point = [target.get(axis, 0.0) for axis in range(9)]
    moves, _ = placed(rows_of(1, kind=kind, rate=600.0, target=point), law=law, scale=INCH, feed_scale=INCH)
    assert moves[0]["rate"] == pytest.approx(rate, rel=1e-15)
    assert moves[0]["law"] == law


def test_a_feed_counts_in_the_unit_it_was_given_in() -> None:
    rows = rows_of(5, kind=[1, COMMENT_ROW, FEED_ROW, 1, 1], rate=[60, 0, 120, 120, 120])
    rows["target"][:, 0] = [1, 0, 0, 2, 3]
    moves, placement = placed(rows, scale=INCH, feed_scale=1.0, feed=60.0)
    assert list(moves["rate"]) == pytest.approx([1.0, 2 * INCH, 2 * INCH])
    assert (placement.feed, placement.feed_scale) == (120.0, INCH)


def test_refuses_what_c_must_not_see() -> None:
    with pytest.raises(ValueError, match="type of a move"):
        placed(np.zeros(1))
    with pytest.raises(ValueError, match="as much room"):
        place(rows_of(2), new_placement(), rows_of(1))
    with pytest.raises(ValueError, match="no plane"):
        placed(rows_of(1), plane=3)


def test_moves_get_the_power_in_force_where_it_is_filled_in() -> None:
    rows = rows_of(4, kind=[1, SPEED_ROW, 1, 0], rate=[60, 250, 60, 0])
    placement = new_placement()
    placement.speed, placement.fills, placement.lit = 100.0, 1, 1
    out = np.zeros(4, dtype=MOVE)
    assert place(rows, placement, out) == 3
    assert out["power"][:3].tolist() == [100.0, 250.0, 250.0]
    assert (placement.speed, placement.new_speed) == (250.0, 1)
    placement.lit = 0
    place(rows, placement, out)
    assert not out["power"][:3].any()
