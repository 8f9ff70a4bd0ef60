import pytest

from trochia.errors import ParseError
from trochia.languages.gcode import MOST_PROBLEMS, problems, read


def lines_of(text: str) -> list[int]:
    return [error.source.line for error in problems(text, name="part.ngc") if error.source is not None]


def test_a_good_program_has_none():
    assert problems("G0 X1\nM2\n") == []


def test_every_wrong_line_is_named_once():
    assert lines_of("G0 X1\nfoo\nG1 X2 F100\nG1 X3 X4\nG17 G18\nG0 X5\nM2\n") == [2, 4, 5]


def test_one_missing_feed_is_not_reported_for_every_line():
    assert lines_of("G1 X1\nX2\nX3\nM2\n") == [1]


def test_one_missing_motion_code_is_not_reported_for_every_line():
    assert lines_of("X1\nX2\nX3\nM2\n") == [1]


def test_a_wrong_line_does_not_make_the_next_arc_wrong():
    assert lines_of("F100\nG1 X10 Y0 Q3\nG2 X12 Y0 I1\nM2\n") == [2]


@pytest.mark.parametrize("text", ["G0 @5\n@6\n@7\nM2\n", "@5 ^1\n@6\n^7\nM2\n", "G91 G0 @5 ^3\n@6\nM2\n"])
def test_one_missing_angle_or_motion_code_is_not_reported_for_every_line(text):
    assert lines_of(text) == [1]


def test_a_missing_end_comes_after_the_others():
    assert lines_of("foo\nG0 X1\n") == [1, 2]


@pytest.mark.parametrize("text", [b"", b"\n \n", b"G0\0\n"])
def test_what_is_no_program_at_all_is_one_error(text):
    assert len(problems(text)) == 1


def test_reading_stops_when_nothing_is_right():
    assert len(problems("foo\n" * (MOST_PROBLEMS + 50))) == MOST_PROBLEMS


def test_the_whole_report_names_place_line_and_remedy():
    with pytest.raises(ParseError) as caught:
        read("G0 X1\nG0 X1 Y2 X3\nM2\n", name="part.ngc")
    assert str(caught.value) == (
        "part.ngc:2:10: the word X stands twice on the line\n"
        "    G0 X1 Y2 X3\n"
        "             ^\n"
        "  Keep one of them."
    )  # fmt: skip


def test_block_delete_leaves_lines_out():
    text = "G0 X1\n/ G0 X2\n/foo\nM2\n"
    assert lines_of(text) == [3]
    assert len(read(text, block_delete=True).moves) == 1
    assert len(read(text.replace("/foo\n", "")).moves) == 2


def test_text_outside_latin_1_can_stand_in_comments():
    assert len(read("(π ≈ 3)\nG0 X1\nM2\n").moves) == 1
