import pytest

from trochia.errors import ParseError
from trochia.languages.gcode.place import Place, column_of
from trochia.languages.gcode.reader import LONGEST_LINE, read_line


def read(text: str | bytes):
    return read_line(Place("part.ngc", 7, text if isinstance(text, bytes) else text.encode("latin-1")))


def words(text: str) -> list[tuple[str, float]]:
    return [(letter, value) for letter, value, _ in read(text).words]


def test_blanks_and_case_do_not_matter():
    assert words("g 0 X 1 . 5\ty-\t2 \r") == words("G0X1.5Y-2") == [("g", 0.0), ("x", 1.5), ("y", -2.0)]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("x1", 1.0),
        ("x.5", 0.5),
        ("x5.", 5.0),
        ("x-.25", -0.25),
        ("x+3", 3.0),
        ("x--1", 1.0),
        ("x+-1", -1.0),
        ("x007", 7.0),
    ],
)
def test_forms_of_a_number(text, value):
    assert words(text) == [("x", value)]


def test_line_number_and_block_delete_are_no_words():
    line = read("/ N10.5 G1 X2")
    assert [letter for letter, *_ in line.words] == ["g", "x"]


@pytest.mark.parametrize(
    ("text", "comment"),
    [
        ("G0 (one) X1 (two)", "two"),
        ("(  leading) ", "leading"),
        ("(trailing  )", "trailing  "),
        ("()", None),
        ("(a) ()", None),
        ("(a ; b) ; (c)", "a ; b"),
        ("G0 ; (c)", None),
        ("(Größe)", "Größe"),
    ],
)
def test_the_last_comment_counts(text, comment):
    assert read(text).comment == comment


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("G1 X1 !", 7),
        ("  G1  X1  ! Y2", 11),
        ("G1 (a comment) X1 ! Y2", 19),
        ("G1 X1.2.3", 5),
        ("G1 X Y2", 4),
        ("\tG1\tX", 5),
        ("G1 X1 (open", 7),
        ("G1 (one (two))", 9),
        ("G1 X1)", 6),
        ("G1 N5 X1", 4),
        ("G1 X1 % Y1", 7),
        ("G1 X(5)5", 4),
    ],
)
def test_an_error_points_at_its_column(text, column):
    with pytest.raises(ParseError) as caught:
        read(text)
    assert caught.value.source is not None
    assert (caught.value.source.file, caught.value.source.line, caught.value.source.column) == ("part.ngc", 7, column)
    assert caught.value.text == text


def test_polar_words_are_words():
    assert [word[:2] for word in read("g0 @1.5 ^[2 * 30]").words] == [("g", 0.0), ("@", 1.5), ("^", 60.0)]


def test_a_line_may_be_as_long_as_the_reference_allows():
    assert len(read("(" + "a" * (LONGEST_LINE - 2) + ")").comment or "") == LONGEST_LINE - 2
    with pytest.raises(ParseError, match="longer than 252"):
        read("(" + "a" * (LONGEST_LINE - 1) + ")")


def test_column_of_counts_blanks_and_comments():
    assert [column_of(b"G1 (c) X 2", index) for index in (0, 1, 2, 4, 5)] == [1, 2, 4, 8, 10]
