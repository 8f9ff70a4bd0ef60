"""Canonical text in C against Python's own rounding."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from trochia.kernels.gcode import COMMENT_ROW, FEED_ROW, PlainReader, Rows
from trochia.kernels.layout import MOVE

TEXT = b"G1 X1 (a remark)\n"


def rows_of(count: int, **columns: object) -> Rows:
    """Return rows of the given columns, behind a reader's buffers."""
    reader = PlainReader(TEXT + b"\n" * 8 + b"F1\n" * count, max(count, 3) + 3)
    reader.modal.feed, reader.modal.axes, reader.modal.line = 1.0, 0x3F, 1
    reader.modal.offset = len(TEXT)
    rows = reader.read()
    assert len(rows) == count
    for name, values in columns.items():
        rows.array()[name] = values
    return rows


def text_of(rows: Rows) -> str:
    text, done = rows.canon()
    assert done == len(rows)
    return text.decode()


NUMBERS = st.one_of(
    st.floats(-1e11, 1e11, exclude_min=True, exclude_max=True),
    st.integers(-(10**9), 10**9).map(lambda n: n / 2**16),  # many of these lie exactly between two
    st.integers(-(10**9), 10**9).map(lambda n: (n + 0.5) / 1e4),  # and these nearly
)


@given(NUMBERS)
@example(-0.0)
@example(-0.00004)
@example(0.00005)
@example(0.00015)
@example(99999999999.99995)
def test_numbers_are_rounded_as_python_rounds(x: float) -> None:
    assert text_of(rows_of(1, kind=FEED_ROW, rate=x)) == f"SET_FEED_RATE({x:.4f})\n"


def test_a_tie_is_decided_by_the_exact_value() -> None:
    low, high = math.nextafter(0.00025, 0.0), math.nextafter(0.00025, 1.0)
    assert Fraction(low) < Fraction(25, 10**5) < Fraction(high)
    rows = rows_of(3, kind=FEED_ROW, rate=[low, high, 0.03125])
    assert text_of(rows).split() == ["SET_FEED_RATE(0.0002)", "SET_FEED_RATE(0.0003)", "SET_FEED_RATE(0.0312)"]


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        ({"kind": 0}, "STRAIGHT_TRAVERSE(1.0000, 2.0000, 3.0000, 4.0000, 5.0000, 6.0000)\n"),
        ({"kind": 1}, "STRAIGHT_FEED(1.0000, 2.0000, 3.0000, 4.0000, 5.0000, 6.0000)\n"),
        ({"kind": 2, "turns": -1, "plane": 0},
         "ARC_FEED(1.0000, 2.0000, 0.5000, -0.2500, -1, 3.0000, 4.0000, 5.0000, 6.0000)\n"),
        ({"kind": 2, "turns": 12, "plane": 1},
         "ARC_FEED(2.0000, 3.0000, 0.5000, -0.2500, 12, 1.0000, 4.0000, 5.0000, 6.0000)\n"),
        ({"kind": 2, "turns": 1, "plane": 2},
         "ARC_FEED(3.0000, 1.0000, 0.5000, -0.2500, 1, 2.0000, 4.0000, 5.0000, 6.0000)\n"),
    ],
)  # fmt: skip
def test_moves(row: dict[str, int], expected: str) -> None:
    rows = rows_of(1, target=np.arange(1.0, 10.0), centre=(0.5, -0.25), **row)
    assert text_of(rows) == expected


def test_comments_stand_in_the_text() -> None:
    reader = PlainReader(TEXT)
    reader.modal.axes, reader.modal.feed = 0x3F, 1.0
    rows = reader.read()
    assert rows.comment(0) == "a remark"
    assert text_of(rows).splitlines()[0] == 'COMMENT("a remark")'


@pytest.mark.parametrize(
    "row",
    [
        {"kind": 1, "target": 1e11}, {"kind": 0, "target": math.nan}, {"kind": 2, "centre": -math.inf},
        {"kind": FEED_ROW, "rate": -1e11}, {"kind": 2, "plane": 3}, {"kind": 7},
        {"kind": COMMENT_ROW, "target": 1e9}, {"kind": COMMENT_ROW, "target": -1.0}, {"kind": COMMENT_ROW, "turns": -1},
        {"kind": COMMENT_ROW, "turns": 10**6}, {"kind": COMMENT_ROW, "target": math.nan},
    ],
)  # fmt: skip
def test_leaves_to_python_what_it_cannot_print(row: dict[str, float]) -> None:
    rows = rows_of(3, kind=FEED_ROW, rate=1.0)
    for name, value in row.items():
        rows.array()[name][1] = value
    text, done = rows.canon()
    assert (text, done) == (b"SET_FEED_RATE(1.0000)\n", 1)
    assert rows.canon(2) == (b"SET_FEED_RATE(1.0000)\n", 3)


@given(st.binary(min_size=MOVE.itemsize, max_size=MOVE.itemsize))
def test_any_bits_print_or_are_left(data: bytes) -> None:
    rows = rows_of(1)
    rows.array().view(np.uint8)[:] = np.frombuffer(data, np.uint8)
    text, done = rows.canon()
    assert (done == 1) == text.endswith(b")\n")


def test_refuses_a_start_outside_the_batch() -> None:
    with pytest.raises(IndexError):
        rows_of(1).canon(2)
