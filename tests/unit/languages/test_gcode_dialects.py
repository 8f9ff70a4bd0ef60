"""Dialects: every difference of the table, each with what it means in the language itself."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.cli.options import DIALECT_NAMES
from trochia.errors import ParseError, ProgramError, UnknownCodeError
from trochia.languages import gcode
from trochia.languages.gcode.adapt import adapt
from trochia.languages.gcode.canon import Canon
from trochia.languages.gcode.dialects import DIALECTS, FANUC, GRBL, LINUXCNC, MARLIN
from trochia.languages.gcode.reading import Reading
from trochia.program import Dwell, Spindle


def canon(text: str, dialect=LINUXCNC) -> tuple[list[str], list[tuple[int, str]]]:
    out: list[bytes] = []
    remarks: list[tuple[int, str]] = []
    reading = Reading(dialect=dialect, on_remark=lambda line, said: remarks.append((line, said)))
    gcode.interpret(text.encode("latin-1"), Canon(out.append), name="part.ngc", reading=reading)
    return b"".join(out).decode().split("\n"), remarks


def means(text: str, dialect, same: str) -> list[tuple[int, str]]:
    """Assert that a text means what another means in LinuxCNC's language; return the remarks."""
    found, remarks = canon(text, dialect)
    assert found == canon(same)[0]
    return remarks


def test_the_command_line_knows_every_dialect():
    assert tuple(DIALECTS) == DIALECT_NAMES


def test_linuxcnc_needs_an_end():
    with pytest.raises(ParseError, match="M2"):
        canon("G0 X1\n")


@pytest.mark.parametrize("dialect", [GRBL, FANUC, MARLIN])
@pytest.mark.parametrize("text", ["G0 X1\n", "G0 X1", "G0 X1 (M2)\n", "G0 X1 ; M30\n"])
def test_the_others_are_ended_with_a_warning(dialect, text):
    remarks = means(text, dialect, text.rstrip("\n") + "\nM2\n")
    assert "has no M2" in remarks[-1][1]


@pytest.mark.parametrize("dialect", [GRBL, FANUC, MARLIN])
@pytest.mark.parametrize("text", ["G0 X1\nM2\n", "G0X1M30\n", "%\nG0 X1\n%\n", "g0 x1\nm02\n"])
def test_what_has_an_end_is_left_alone(dialect, text):
    assert means(text, dialect, text) == []


@pytest.mark.parametrize(
    ("dialect", "text", "seconds"),
    [
        (LINUXCNC, "G4 P2", 2.0), (GRBL, "G4 P0.5", 0.5), (FANUC, "G4 P500", 0.5), (FANUC, "G04 X1.5", 1.5),
        (FANUC, "G4 U2.", 2.0), (MARLIN, "G4 P250", 0.25), (MARLIN, "G4 S3", 3.0), (FANUC, "G4 P[100*5]", 0.5),
    ],
)  # fmt: skip
def test_dwell_has_the_units_of_the_dialect(dialect, text, seconds):
    program = gcode.read(text + "\nM2\n", reading=Reading(dialect=dialect))
    assert [action.seconds for action in program.actions if isinstance(action, Dwell)] == [pytest.approx(seconds)]


@pytest.mark.parametrize("dialect", [GRBL, FANUC, MARLIN])
def test_unknown_m_codes_are_left_out_with_a_warning(dialect):
    remarks = means("M117\nG0 X1\nM2\n", dialect, "\nG0 X1\nM2\n")
    assert remarks == [(1, "M117 is not known here, and is left out")]


def test_unknown_m_codes_are_errors_in_linuxcnc():
    with pytest.raises(UnknownCodeError):
        canon("M777\nM2\n")


def test_marlin_leaves_out_the_whole_line_of_an_unknown_code():
    remarks = means("M104 S210 T0\nM140 S60\nG0 X1\nM2\n", MARLIN, "\n\nG0 X1\nM2\n")
    assert [line for line, _ in remarks] == [1, 2]


def test_marlin_fan_is_the_beam():
    means("M106 S128\nG1 X5 F60\nM107\nM2\n", MARLIN, "M3 S128\nG1 X5 F60\nM5\nM2\n")
    program = gcode.read("M106\nG0 X1\nM107\nM2\n", reading=Reading(dialect=MARLIN))
    assert [action.speed for action in program.actions if isinstance(action, Spindle) and action.direction] == [255.0]


def test_marlin_checksums_and_extruder_words_are_left_out():
    remarks = means("N3 G1 X5 E0.2 F60*36\nN4 G1 X6 E.3*1\nM2\n", MARLIN, "N3 G1 X5 F60\nN4 G1 X6\nM2\n")
    assert remarks == [(1, "E words are left out")]


@pytest.mark.parametrize(("text", "same"), [("G28", "G28"), ("G28 X Y", "G28 X0 Y0"), ("G28 Z0", "G28 Z0")])
def test_marlin_homes_to_the_stored_point(text, same):
    assert "stored point" in means(f"{text}\nM2\n", MARLIN, f"{same}\nM2\n")[0][1]


@pytest.mark.parametrize("code", ["G10", "G11", "G29"])
def test_marlin_codes_that_mean_something_else_are_left_out(code):
    assert "left out" in means(f"{code}\nM2\n", MARLIN, "\nM2\n")[0][1]


@pytest.mark.parametrize("line", ["$H", "$100=250", " $$", "?"])
def test_grbl_commands_are_refused_with_their_place(line):
    with pytest.raises(UnknownCodeError, match="GRBL") as caught:
        canon(f"G0 X1\n{line}\n", GRBL)
    assert caught.value.source is not None
    assert caught.value.source.line == 2


def test_grbl_dynamic_power_is_remarked_once():
    remarks = means("M4 S100\nM5\nM4\nM2\n", GRBL, "M4 S100\nM5\nM4\nM2\n")
    assert [line for line, _ in remarks] == [1]


@pytest.mark.parametrize("first", ["O1234", "O0001 (PART)", ":77", "o12"])
def test_fanuc_program_numbers_are_no_subroutines(first):
    comment = first[first.find("(") :] if "(" in first else ""
    means(f"%\n{first}\nN10 G0 X1\nM30\n%\n", FANUC, f"%\n{comment}\nN10 G0 X1\nM30\n%\n")


def test_fanuc_mirrors_axes_arcs_and_sides():
    text = "M70\nG0 X5 Y1\nM80\nM71\nG0 X5 Y1\nM81\nG0 X5 Y1\nM2\n"
    remarks = means(text, FANUC, "\nG0 X-5 Y1\n\n\nG0 X5 Y-1\n\nG0 X5 Y1\nM2\n")
    assert [line for line, _ in remarks] == [1, 4]
    means("G0 X0 Y0\nM70\nG2 X4 Y0 I2 F60\nM2\n", FANUC, "G0 X0 Y0\n\nG3 X-4 Y0 I-2 F60\nM2\n")
    means("G0 X0 Y0\nM70\nM71\nG2 X4 Y0 I2 F60\nM2\n", FANUC, "G0 X0 Y0\n\n\nG2 X-4 Y0 I-2 F60\nM2\n")


def test_fanuc_numbers_without_a_point_are_whole_units():
    means("G0 X100 Y2.\nM2\n", FANUC, "G0 X100. Y2\nM2\n")


def test_errors_name_the_line_of_the_dialects_text():
    with pytest.raises(ProgramError) as caught:
        canon("O1\nG0 X1\nG1 X2 Q7 F1\nM30\n", FANUC)
    assert caught.value.source is not None
    assert caught.value.source.line == 3


@given(text=st.text(st.sampled_from("GMXYZFSPIJKO0123456789.-+$*;()% \n[]eE"), max_size=60))
@pytest.mark.parametrize("dialect", [GRBL, FANUC, MARLIN])
def test_any_text_is_read_or_refused(text, dialect):
    try:
        adapted, _ = adapt(text.encode(), dialect)
    except UnknownCodeError:
        return
    assert adapted.count(b"\n") >= text.count("\n")
    assert isinstance(gcode.problems(text, reading=Reading(dialect=dialect)), list)


@pytest.mark.parametrize(
    ("text", "same"),
    [("G4 P1 2", "G4 P0.012"), ("G4 P--1500", "G4 P1.5"), ("G4 P - -20", "G4 P.02"), ("G4 P+.5", "G4 P0.0005"),
     ("G 4 P1 500 (wait)", "G4 P1.5 (wait)"), ("G0 X1 0 Y - 2", "G0 X10 Y-2")],
)  # fmt: skip
def test_numbers_are_read_through_their_blanks_and_signs(text, same):
    means(f"{text}\nM2\n", MARLIN, f"{same}\nM2\n")


def test_a_mirrored_word_keeps_its_signs():
    means("M70\nG1 F1 X--3 Y - 4\nX- 1 0\nM2\n", FANUC, "\nG1 F1 X-3 Y-4\nX10\nM2\n")


def test_a_wait_of_negative_time_stays_one():
    with pytest.raises(ParseError):
        canon("G4 P-1\nM2\n", MARLIN)
