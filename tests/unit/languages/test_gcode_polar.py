"""Polar words against complex arithmetic, and what cannot be read."""

from __future__ import annotations

import cmath
from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import ModalConflictError, ParseError, UnknownCodeError
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret

SIZE = st.integers(1, 4000).map(lambda count: count / 8)
TURN = st.integers(-720, 720)


def ends(program: str, axes: str = "XYZABCUVW") -> list[complex]:
    """Return where the straight moves of a program end in XY."""
    out: list[bytes] = []
    interpret(program.encode(), Canon(out.append), name="p", axes=axes)
    rows = b"".join(out).decode().split("\n")
    words = [row[row.index("(") + 1 :].split(", ") for row in rows if row.startswith("STRAIGHT_")]
    return [complex(float(word[0]), float(word[1])) for word in words]


def polar(distance: float, degrees: float) -> complex:
    """Return the point at a distance and an angle."""
    return cmath.rect(distance, degrees * pi / 180)


@given(distance=SIZE, angle=TURN, other=SIZE, turned=TURN)
def test_a_missing_word_keeps_its_present_value(distance, angle, other, turned):
    found = ends(f"G0 @{distance} ^{angle}\n@{other}\n^{turned}\nM2\n")
    expected = [polar(distance, angle), polar(other, angle), polar(other, turned)]
    assert max(abs(a - b) for a, b in zip(found, expected, strict=True)) < 1.5e-4


@given(distance=SIZE, angle=TURN, more=SIZE, turned=TURN)
def test_incremental_words_add_to_distance_and_angle(distance, angle, more, turned):
    found = ends(f"G0 @{distance} ^{angle}\nG91 @{more} ^{turned}\nM2\n")
    assert abs(found[-1] - polar(distance + more, angle + turned)) < 1.5e-4


def test_repeats_of_a_cycle_turn_on():
    found = ends("F9 G0 X10\nG91 G81 ^30 Z-1 R1 L12\nM2\n")
    assert abs(found[-1] - 10) < 1e-4
    assert len({(round(point.real, 3), round(point.imag, 3)) for point in found}) == 12


@pytest.mark.parametrize(
    ("program", "kind"),
    [
        ("G0 @1 ^2 @3", ParseError), ("F1 G5.2 @1 ^2 P1", ParseError), ("G0 @1 ^2 Y3", ParseError),
        ("G92 @1 ^2", ParseError), ("G0 @1", ModalConflictError), ("G19\nG0 @1 ^2", ModalConflictError),
        ("@1 ^2", ModalConflictError), ("F9 G0 X1\nG91 G81 @-1 ^3 Z-1 R1", ModalConflictError),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused(program, kind):
    with pytest.raises(kind):
        ends(program + "\nM2\n")


def test_a_machine_without_y_has_no_polar_words():
    with pytest.raises(UnknownCodeError):
        ends("G0 @1 ^2\nM2\n", axes="XZ")
