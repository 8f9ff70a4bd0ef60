"""The plain-line reader in C: what it takes, what it leaves, and the numbers it reads."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.gcode import (
    COMMENT_ROW,
    FEED_ROW,
    OTHER_MOTION,
    SPEED_ROW,
    STOP_END,
    STOP_FULL,
    STOP_LINE,
    PlainReader,
)

RAPID, FEED, ARC = range(3)


def reader_of(text: bytes, capacity: int = 64, **modes: object) -> PlainReader:
    """Return a reader at the start of a text, in G0, feed 100, XYZABC allowed, with the reference's arc tolerances."""
    reader = PlainReader(text, capacity)
    start = {"line": 1, "axes": 0x3F, "motion": 0, "feed": 100.0}
    tolerances = {"least_radius": 0.00127, "spiral": 0.02 * 2**0.5, "spiral_share": 0.001, "spiral_most": 2 * 2**0.5}
    for name, value in (start | tolerances | modes).items():
        setattr(reader.modal, name, value)
    return reader


def kinds_of(text: bytes, **modes: object) -> list[int]:
    """Return the kinds of the rows of a text that must be plain to its end."""
    reader = reader_of(text, **modes)
    rows = reader.read()
    assert reader.modal.stop == STOP_END
    return [rows[k].kind for k in range(len(rows))]


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        (b"", []),
        (b"\n \t\r\n", []),
        (b"N10\n", []),
        (b"; only, a (remark\n", []),
        (b"G1 X1\n", [FEED]),
        (b"g01x-1.5y.5 z+2.\n", [FEED]),
        (b"G 1 X\t1\r\n", [FEED]),
        (b"n5g0a1b2c3", [RAPID]),
        (b"X1\n", [RAPID]),
        (b"G0\n", [RAPID]),
        (b"F900\n", [FEED_ROW]),
        (b"S900\n", [SPEED_ROW]),
        (b"(a) S7 G1 X1 F5\n", [COMMENT_ROW, FEED_ROW, SPEED_ROW, FEED]),
        (b"F0 G0 X1\n", [FEED_ROW, RAPID]),
        (b"X1 F900 G01 ; remark\n", [FEED_ROW, FEED]),
        (b"( hello ) X1 F2\n", [COMMENT_ROW, FEED_ROW, RAPID]),
        (b"G2 X2 I1\n", [ARC]),
        (b"G3 J1\nI1\n", [ARC, ARC]),
        (b"G2 X2 R1\n", [ARC]),
        (b"G2 X2 Y0 R-1.5\n", [ARC]),
    ],
)
def test_takes_plain_lines(text: bytes, kinds: list[int]) -> None:
    assert kinds_of(text) == kinds


@pytest.mark.parametrize(
    "line",
    [
        b"%", b"/G1 X1", b"M3", b"G4 P1", b"X1 S-5", b"G1.5 X1", b"G4", b"G1 G1 X1", b"G1 X1 X2", b"G1 X",
        b"G1 X-", b"G1 X1 2", b"G1 X1..2", b"G1 X.", b"G1 X--1", b"G1 X1e2", b"G1 X#1", b"G1 X[1]", b"G1 U1",
        b"N X1",
        b"N-1 X1", b"X1 N5", b"(a) N5 X1", b"F-1", b"G1 X1 I1", b"G1 X1 R1", b"R5", b"I1", b"G2", b"G2 X1",
        b"G2 X1 I.5 R1", b"G2 X2 I1 K0", b"G2 X4 I1", b"G2 X3 R.5", b"G2 R1", b"G2 X1 Y0 R1", b"G2 X0.001 I0.0005",
        b"G2 X1 R0", b"(msg, hi)", b"(a, b)", b"(logclose)", b"(PROBEOPEN x)", b"(pyreload)", b"()", b"( )", b"(a)(b)",
        b"((a)", b"(a", b"a)", b"(\xe4)", b"X1\rY1", b"X\x001", b";\x00", b"X1 ;\x07", b"\xef\xbb\xbfX1", b"X1*2",
        b"O100", b"X1234567890123456789", b"X0.1234567890123456789", b"X9007199254740993", b"X1 P2", b"@5", b"{",
        b"X" + b"0" * 300,
    ],
)  # fmt: skip
def test_leaves_other_lines_untouched(line: bytes) -> None:
    reader = reader_of(b"G0 X1\n" + line + b"\nG0 X2\n")
    before = len(b"G0 X1\n")
    rows = reader.read()
    modal = reader.modal
    assert (len(rows), modal.stop, modal.offset, modal.line, modal.motion) == (1, STOP_LINE, before, 2, 0)
    assert list(modal.position) == [1.0] + [0.0] * 8
    assert modal.feed == 100.0


@pytest.mark.parametrize("line", [b"G1 X1", b"G1 X1 F0", b"G2 X2 I1"])
def test_leaves_feed_moves_without_feed(line: bytes) -> None:
    reader = reader_of(line, feed=0.0)
    assert len(reader.read()) == 0
    assert reader.modal.stop == STOP_LINE


def test_other_motion_modes_need_a_code() -> None:
    reader = reader_of(b"G1 X1\nX2\n", motion=OTHER_MOTION)
    assert len(reader.read()) == 2
    reader = reader_of(b"X2\n", motion=OTHER_MOTION)
    assert len(reader.read()) == 0


def test_axes_mask() -> None:
    assert kinds_of(b"U1 V2 W3\n", axes=0x1FF) == [RAPID]
    assert len(reader_of(b"A1\n", axes=0x07).read()) == 0


@given(st.from_regex(r"[+-]?([0-9]{1,9}\.?[0-9]{0,9}|\.[0-9]{1,15})", fullmatch=True))
def test_numbers_are_those_of_python(number: str) -> None:
    reader = reader_of(f"X{number}\n".encode())
    rows = reader.read()
    value = float(number)
    if len(rows):
        got = rows[0].target[0]
        assert (got, math.copysign(1, got)) == (value, math.copysign(1, value))
    else:  # left to Python, because dividing would round twice
        assert int("".join(c for c in number if c.isdigit())) >= 2**53


def test_incremental_adds_to_the_position() -> None:
    reader = reader_of(b"X0.1 Y1\nX0.2\n", incremental=1, position=[0.3, 1.0, 2.0, 0, 0, 0, 0, 0, 0])
    rows = reader.read()
    assert list(rows[1].target)[:3] == [0.3 + 0.1 + 0.2, 2.0, 2.0]


@pytest.mark.parametrize(
    ("text", "modes", "centre", "turns"),
    [
        (b"G2 X2 I1", {}, (1, 0), -1),
        (b"G3 X2 I1 J0", {"centre_absolute": 1}, (1, 0), 1),
        (b"G3 X2 Y2 R2", {}, (0, 2), 1),
        (b"G2 X2 Y2 R2", {}, (2, 0), -1),
        (b"G3 X2 Y2 R-2", {}, (2, 0), 1),
        (b"G2 Y2 Z2 J2", {"plane": 1}, (2, 0), -1),
        (b"G2 Z2 X2 R2", {"plane": 2}, (2, 0), -1),
        (b"G2 Z3 I1", {}, (1, 0), -1),
    ],
)
def test_arc_centres(text: bytes, modes: dict[str, object], centre: tuple[float, float], turns: int) -> None:
    rows = reader_of(text, **modes).read()
    assert tuple(rows[0].centre) == pytest.approx(centre, abs=1e-12)
    assert (rows[0].turns, rows[0].kind) == (turns, ARC)


@given(st.binary(max_size=200))
def test_any_bytes_stop_at_a_line(data: bytes) -> None:
    reader = reader_of(data)
    reader.read()
    offset, line = reader.modal.offset, reader.modal.line
    assert offset == 0 or offset == len(data) or data[offset - 1 : offset] == b"\n"
    assert line == 1 + data.count(b"\n", 0, offset) + (offset == len(data) > 0 and data[-1:] != b"\n")


WORDS = st.sampled_from(
    ["G0", "g1", "G2", "G3", "X1.5", "Y-2", "Z.5", "I1", "J-1", "R2", "F5", "(c)", ";", " ", "\t", "N1", "M2", "\r"]
)
LINES = st.lists(st.lists(WORDS, max_size=5).map("".join), max_size=40).map("\n".join)


@given(LINES, st.integers(4, 9))
def test_batches_of_any_size_give_the_same_rows(text: str, capacity: int) -> None:
    whole, parts = reader_of(text.encode(), 200), reader_of(text.encode(), capacity)
    rows = whole.read().array().copy()
    got = [parts.read().array().copy()]
    while parts.modal.stop == STOP_FULL:
        got.append(parts.read().array().copy())
    assert b"".join(r.tobytes() for r in got) == rows.tobytes()
    assert (parts.modal.offset, parts.modal.line) == (whole.modal.offset, whole.modal.line)


def test_refuses_what_c_must_not_see() -> None:
    with pytest.raises(ValueError, match="at least 4"):
        PlainReader(b"", 2)
    with pytest.raises(ValueError, match="behind"):
        reader_of(b"X1", offset=3).read()
    with pytest.raises(ValueError, match="plane"):
        reader_of(b"X1", plane=3).read()
    with pytest.raises(IndexError):
        reader_of(b"X1").read()[1]
