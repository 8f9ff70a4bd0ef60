"""With the C core or without: a program gives the same calls, the same text, the same errors."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from trochia.errors import ProgramError
from trochia.kernels.gcode import COMMENT_ROW, FEED_ROW, SPEED_ROW, Rows
from trochia.languages.gcode.builder import Builder
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import blocks
from trochia.program import WorkState

STRAIGHT = ("straight_traverse", "straight_feed")


def exact(value: object) -> object:
    """Return a value as something whose equality is equality of bits."""
    if isinstance(value, float):
        return value.hex()
    return tuple(exact(v) for v in value) if isinstance(value, (list, tuple)) else value


class Recorder:
    """A sink that keeps every call, rows of the fast path as the calls they stand for."""

    def __init__(self) -> None:
        self.line = 0
        self.calls: list[object] = []
        self.rate = 0.0
        self.fast = 0

    def set_feed_rate(self, rate: float) -> None:
        self.rate = rate
        self.calls.append(("set_feed_rate", self.line, exact(rate)))

    def __getattr__(self, name: str) -> Any:
        return lambda *values, **named: self.calls.append((name, self.line, exact(values), named))

    def moves(self, rows: Rows) -> None:
        self.fast += len(rows)
        for k in range(len(rows)):
            row = rows[k]
            self.line = row.line
            target, centre = list(row.target), (row.centre[0], row.centre[1])
            if row.kind == COMMENT_ROW:
                self.comment(rows.comment(k))
            elif row.kind == FEED_ROW:
                self.set_feed_rate(row.rate)
            elif row.kind == SPEED_ROW:
                self.set_spindle_speed(row.rate)
            elif row.kind in (0, 1):
                getattr(self, STRAIGHT[row.kind])(target)
            else:
                self.arc_feed(target, centre, row.turns, row.plane)
            if row.kind in (1, 2):
                assert row.rate == (self.rate or 1.0)  # 1.0: after an error the missing feed is made up


def outcome(text: bytes, *, fast: bool, go_on: bool) -> tuple[object, ...]:
    """Return the calls, the canonical text, the errors and the number of lines."""
    recorder, printed, errors = Recorder(), bytearray(), list[str]()

    def run(sink: Any) -> int:
        found: list[ProgramError] = []
        lines = 0
        try:
            lines = max(blocks(text, sink, name="p", fast=fast, on_error=found.append if go_on else None))
        except ProgramError as error:
            found.append(error)
        errors.extend(str(error) for error in found)
        return lines

    lines = run(recorder), run(Canon(printed.extend))
    return recorder.calls, bytes(printed), errors, lines


SIZES = st.one_of(
    st.integers(-40, 40).map(lambda n: n / 4),
    st.integers(-(10**6), 10**6).map(lambda n: n / 10**4),
    st.floats(-1e3, 1e3).map(lambda x: round(x, 6)),
    st.sampled_from([0.0, 1.0, 1e12, 0.0009, 0.00123, 123456789012.5]),
)


@st.composite
def numbers(draw: st.DrawFn) -> str:
    """Draw a number as people and post processors write it."""
    value = draw(SIZES)
    text = f"{value:.{draw(st.integers(0, 6))}f}"
    text = text.rstrip("0") if "." in text and draw(st.booleans()) else text
    text = (
        text.replace("0.", ".", 1)
        if text.startswith(("0.", "-0.")) and text[-1] != "." and draw(st.booleans())
        else text
    )
    return "+" + text if text[0] != "-" and draw(st.integers(0, 9)) == 0 else text


MOTION = ["G0", "G1", "G2", "G3", "g01", "G00", "g 2", "G03", "G1."]
STRAIGHTS = ["G0", "G1", "g01", "G00", "g 0", "G1."]
BLANK = st.sampled_from(["", " ", "\t", "  "])


@st.composite
def plain_lines(draw: st.DrawFn) -> str:
    """Draw a line of the fast path's words; not always one it takes, nor always one that is right."""
    wrong = draw(st.integers(0, 7)) == 0
    words = [draw(st.sampled_from(MOTION if wrong else STRAIGHTS))] if draw(st.integers(0, 2)) else []
    letters = draw(st.lists(st.sampled_from("XYZxyzABCU" if wrong else "XYZABC"), max_size=3, unique=True))
    words += [axis + draw(numbers()) for axis in letters]
    words += draw(st.sampled_from([[], [], [], ["F100"], ["f.5"], ["F" + draw(numbers()).lstrip("-")]]))
    words += draw(st.sampled_from([["I1"], ["R" + draw(numbers())], ["J" + draw(numbers()), "I1"]])) if wrong else []
    words += draw(st.sampled_from([[], [], [], ["S100"], ["s0"], ["S" + draw(numbers())]]))
    words = draw(st.permutations(words))
    number = draw(st.sampled_from(["", "", "", "N10", "n 5 ", "N1.5"]))
    end = draw(st.sampled_from(["", "", "", "(a remark)", "; note, (x", "( A/b #1 )", "(MSG, hi)", "\r", "(a)(b)"]))
    return number + draw(BLANK).join(words) + end


@st.composite
def arcs(draw: st.DrawFn) -> str:
    """Draw an arc that is right in one or the other distance mode."""
    i, j = draw(st.integers(1, 40)) / 8, draw(st.integers(-40, 40)) / 8
    code = draw(st.sampled_from(["G2", "G3", ""]))
    plane = draw(st.sampled_from(["XYIJ", "XYIJ", "YZJK", "ZXKI"]))
    first, second, third, fourth = plane
    forms = [
        f"{third}{i}{fourth}{j}",
        f"{first}{2 * i}{second}{2 * j}{third}{i}{fourth}{j}",
        f"{first}{i}{second}{j}R{draw(st.integers(-9, 9)) + 0.5}",
        f"{first}{2 * i}{second}{2 * j}R{(i * i + j * j) ** 0.5:.9f}",
        f"{first}{i + j:.4f}{second}{j - i:.4f}{third}{i:.4f}{fourth}{j:.4f}",
        f"{first}{i}R{20 + j}",
    ]
    return code + draw(st.sampled_from(forms)) + draw(st.sampled_from(["", "", "Z1.5", "A3", "F20", "P2"]))


MODES = st.sampled_from(
    ["G90", "G91", "G90.1", "G91.1", "G17", "G18", "G19", "G20", "G21", "G80", "G93", "G94", "G95", "G92 X1 Y2",
     "G92.1", "G54", "G55", "G64 P.1", "G61", "M3 S100", "M5", "G4 P.1", "G53 G0 Z1", "G28", "T1 M6", "G93 G1 X1 F2",
     "/G0 X1", "F100", "G91 F200 G1 X1", "G90 G0 X0 Y0", "M0", "G1 G91", "F0", "F-1", "(MSG, hi)", "g43 h1",
     "g17 g2 x1 r5"]
)  # fmt: skip
NOISE = st.text(alphabet="GXYZIJRFN0123456789.+-() ;%#/\t\r\xe4*M", max_size=14)
ENDS = st.sampled_from(["M2", "M30\n", "\n", "%", "M2\nG0 X1\n", "G1 X1"])


@st.composite
def programs(draw: st.DrawFn) -> bytes:
    """Draw a program that mixes what the core takes with what it leaves."""
    noise = draw(st.booleans())
    kinds = [plain_lines(), plain_lines(), arcs(), arcs(), MODES] + ([NOISE] if noise else [])
    lines = draw(st.lists(st.one_of(kinds), max_size=25))
    head = draw(st.sampled_from(["", "%\nF1\n", "\n%\nG0 F9\n", "F100 G1\n", "G91 F100 G2 I1\n", "G91 G20 F9 G1\n"]))
    return (head + "\n".join(lines) + "\n" + draw(ENDS)).encode("latin-1")


@pytest.mark.parametrize("go_on", [False, True])
@given(text=programs())
@example(text=b"F100\nG1 X1\nX2 (a)\n(b) Y1\nG2 I1\nM2\n")
@example(text=b"F-0\nG0X-0\nX-.00001\nG91 F1 G2 X-0 I1\nM2")
@example(text=b"G91 F1\n" + b"G1 X.1 (x)\n" * 3000 + b"M2\n")
def test_fast_path_changes_nothing(text: bytes, *, go_on: bool) -> None:
    assert outcome(text, fast=True, go_on=go_on) == outcome(text, fast=False, go_on=go_on)


@given(text=programs(), degrees=st.sampled_from([0.0, 0.0, 30.0]), room=st.sampled_from([0, 1000]))
def test_fast_path_builds_the_same_program(text: bytes, degrees: float, room: int) -> None:
    work = WorkState(rotations=(degrees,) + (0.0,) * 8).placed(X=1.5, A=2.0)
    built: list[object] = []
    for fast in (True, False):
        builder = Builder("p", (0.5,) * 9, room)
        try:
            lines = max(blocks(text, builder, name="p", work=work, start=(0.5,) * 9, fast=fast))
            program = builder.program(lines)
            built.append((program.moves.tobytes(), program.actions, program.lines))
        except ProgramError as error:
            built.append(str(error))
    assert built[0] == built[1]


@given(data=st.binary(max_size=120))
def test_any_bytes_end_the_same(data: bytes) -> None:
    assert outcome(data, fast=True, go_on=True) == outcome(data, fast=False, go_on=True)


def test_fast_path_takes_what_it_is_for() -> None:
    recorder = Recorder()
    text = b"g21 g90\nf100\n" + b"g1 x1 y2 z3\n" * 50 + b"N5 G02 X1 Y2 I1 J0 (arc)\nm2\n"
    assert list(blocks(text, recorder, name="p"))[-1] == text.count(b"\n")
    assert recorder.fast == 53
