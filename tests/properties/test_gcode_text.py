"""How a program is written does not change what it does."""

import numpy as np
from hypothesis import given, reject
from hypothesis import strategies as st

from trochia.errors import ProgramError
from trochia.languages.gcode import problems, read
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.interpreter import interpret
from trochia.program import WorkState

NUMBER = st.integers(-4000, 4000).map(lambda count: f"{count / 64:.6f}".rstrip("0"))
AXIS_WORDS = st.lists(
    st.tuples(st.sampled_from("XYZA"), NUMBER), min_size=1, max_size=4, unique_by=lambda word: word[0]
).map(lambda words: [letter + value for letter, value in words])
LINE = st.one_of(
    st.builds(lambda code, axes: [code, *axes], st.sampled_from(["G0", "G1", "G1 F60"]), AXIS_WORDS),
    st.builds(
        lambda i, j, code: [code, f"I{i}", f"J{j}"], st.integers(1, 9), st.integers(0, 9), st.sampled_from(["G2", "G3"])
    ),
    st.sampled_from(["G91", "G90", "G92 X3", "G92.1", "F90", "M3 S5", "G4 P1", "G61.1", "G55"]).map(str.split),
)
LINES = st.lists(LINE, min_size=1, max_size=15)
LENGTHS = [0, 1, 2, 6, 7, 8]  # columns of linear axes


def join(lines: list[list[str]]) -> str:
    return "\n".join(["F100", *(" ".join(line) for line in lines), "M2"]) + "\n"


def canon(text: str) -> bytes:
    out: list[bytes] = []
    interpret(text.encode("latin-1"), Canon(out.append), name="part.ngc")
    return b"".join(out)


def first_error(text: str) -> ProgramError | None:
    try:
        read(text, name="part.ngc")
    except ProgramError as error:
        return error
    return None


@given(lines=LINES, data=st.data())
def test_blanks_case_and_numbering_change_nothing(lines, data):
    noise = st.sampled_from(["", " ", "  ", "\t"])
    rewritten: list[str] = []
    for number, line in enumerate(" ".join(line) for line in lines):
        text = "".join(data.draw(noise) + (c.lower() if data.draw(st.booleans()) else c) for c in line)
        rewritten.append(data.draw(st.sampled_from(["", f"N{number} ", "/", f"/n{number}"])) + text)
    ends = data.draw(st.sampled_from(["\n", "\r\n"]))
    assert canon(ends.join(["F100", *rewritten, "M2"])) == canon(join(lines))


@given(lines=LINES, data=st.data())
def test_the_order_of_words_changes_nothing(lines, data):
    words = [[word for part in line for word in part.split()] for line in lines]
    shuffled = [data.draw(st.permutations(line)) for line in words]
    assert canon(join(shuffled)) == canon(join(lines))


@given(lines=LINES, data=st.data())
def test_empty_lines_and_silent_comments_change_nothing_but_line_numbers(lines, data):
    silent = st.lists(st.sampled_from(["", "; note", "()", "N5", "/"]), max_size=2)
    padded = [
        text for line in lines for text in (*data.draw(silent), " ".join(line) + data.draw(st.sampled_from(["", ";x"])))
    ]
    moved, plain = read("\n".join(["F100", *padded, "M2"])), read(join(lines))
    for column in ("kind", "target", "centre", "turns", "rate", "power", "path_mode"):
        assert np.array_equal(moved.moves[column], plain.moves[column])


@given(lines=LINES, place=st.tuples(*[st.integers(-900, 900)] * 3))
def test_a_part_elsewhere_is_the_same_part(lines, place):
    lines = [line for line in lines if line != ["G55"]]
    here = read(join([["G0", "X0", "Y0", "Z0"], *lines]))
    work = WorkState().placed(**{axis: float(value) for axis, value in zip("XYZ", place, strict=True)})
    there = read(join([["G0", "X0", "Y0", "Z0"], *lines]), work=work)
    offset = np.array([*place, 0, 0, 0, 0, 0, 0], dtype=float)
    assert np.allclose(there.moves["target"] - offset, here.moves["target"], atol=1e-9)
    arcs = here.moves["kind"] == 2
    assert np.allclose(there.moves["centre"][arcs] - offset[:2], here.moves["centre"][arcs], atol=1e-9)


@given(lines=LINES)
def test_the_same_numbers_in_inches_make_the_part_greater(lines):
    metric = read("G21\n" + join(lines))
    try:
        inches = read("G20\n" + join(lines))
    except ProgramError:
        reject()  # the tolerances of arcs are not the same
    assert np.allclose(inches.moves["target"][:, LENGTHS], metric.moves["target"][:, LENGTHS] * 25.4, atol=1e-6)
    assert np.allclose(inches.moves["target"][:, 3:6], metric.moves["target"][:, 3:6], atol=1e-9)


@given(lines=LINES)
def test_canonical_moves_written_as_a_program_are_the_same_moves(lines):
    """The machine-coordinate moves, written out as absolute G-code, read back as themselves."""
    moves = read(join([line for line in lines if line[0] not in ("G2", "G3")])).moves
    text = "".join(
        "{} X{:.9f} Y{:.9f} Z{:.9f} A{:.9f}\n".format("G1 F1" if move["kind"] else "G0", *move["target"][:4])
        for move in moves
    )
    again = read(text + "M2\n").moves
    assert np.array_equal(again["kind"], moves["kind"])
    assert np.allclose(again["target"], moves["target"], atol=1e-9)


@given(text=st.text(st.sampled_from("GXYZFMSPIJKRgxn0123456789.-+/;()% \n\r\t#[o@é"), max_size=60))
def test_any_text_is_read_or_refused_with_a_place(text):
    """No traceback, whatever stands in the file; collecting finds a problem exactly where reading stops."""
    found = problems(text, name="part.ngc")
    refusal = first_error(text)
    assert [str(error) for error in found[:1]] == ([] if refusal is None else [str(refusal)])
    assert all(error.source is not None and error.source.line >= 1 for error in found)


@given(data=st.binary(max_size=80))
def test_any_bytes_are_read_or_refused(data):
    assert isinstance(problems(data), list)
