"""Programs that mutation found: what they ask for is too much, or follows on a line that was refused."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.errors import ParseError, ProgramError
from trochia.languages.gcode import DIALECTS, Reading, problems, read

THREAD = "F1 S1 M3\nG76 Z-1 P1 I1 J0.1 K1 "


@pytest.mark.parametrize(
    "text",
    ["G81 R1\nG8 X1\nM2\n", "G74 K0\nG8 Z1 R1\nM2\n", "G81\nX5\nM2\n"],
    ids=["no depth", "no initial level", "no R"],
)
def test_a_cycle_behind_one_that_was_refused(text: str):
    assert problems(text)[0].source.line == 1


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("F1\nG81 X1 Z-1 R1 L999999999\nM2\n", "at most 10000 times"),
        ("F1\nG83 X1 Z-1 R1 Q0.000000001\nM2\n", "more than 10000 times"),
        ("F1\nG73 X1 Z-1 R1 Q0.001 L9\nM2\n", "more than 10000 times"),
        (THREAD + "H99999999\nM2\n", "more than 10000 passes"),
        (THREAD + "R400\nM2\n", "more than 10000 passes"),
        ("F1\nG3 X10 I5 P33333333333333333333\nM2\n", "more than 1,000,000 turns"),
    ],
)
def test_a_line_that_would_hardly_end(text: str, told: str):
    with pytest.raises(ParseError, match=told) as caught:
        read(text)
    assert caught.value.source is not None
    assert caught.value.source.line == 2


@pytest.mark.parametrize("text", ["S[10**300] M3\nF1\nG8 G1 X2\nG1 X3\nM2\n", "F1 S[10**300] M3\nG1 X1\nM2\n"])
def test_a_speed_beyond_single_precision(text: str):
    assert np.isfinite(read(text).moves["power"]).all()


def test_a_dwell_of_another_dialect_that_is_no_number():
    with pytest.raises(ParseError, match="is no number"):
        read("G4 P1..5\nM2\n", reading=Reading(dialect=DIALECTS["marlin"]))


def test_a_dwell_of_another_dialect_is_written_without_exponent():
    program = read("G4 P0.0001\nM2\n", reading=Reading(dialect=DIALECTS["marlin"]))
    assert program.actions[0].seconds == pytest.approx(1e-7)


def test_a_spline_beyond_all_numbers():
    with pytest.raises(ProgramError, match="not finite") as caught:
        read("F3\nG5.1 Y[exp[700]] I1 J0\nM2\n")
    assert caught.value.source is not None
    assert caught.value.source.line == 2


def test_the_rounding_of_a_number_beyond_all_integers():
    with pytest.raises(ProgramError) as caught:
        read("F1\nG3 X2 R[round[exp[700]]]\nM2\n")
    assert caught.value.source is not None
    assert caught.value.source.line == 2


@pytest.mark.parametrize(
    "text",
    [
        "G18 F1\nG0 X0 Z0\nO100 SUB\nG1 X15 Z-20\nG2 X20 Z-25 I5\nO100 ENDSUB\nG71 Q100 X2 D[7]\nM2\n",
        "G18 F1\nG0 X0 Z0\nO100 SUB\nG1 Z0\nX2\nG2 X5 I[exp[700]]\nO100 ENDSUB\nG71 Q100 D5\nM2\n",
    ],
    ids=["nothing left of it", "an arc beyond all numbers"],
)
def test_a_profile_of_a_lathe_cycle_that_is_gone(text: str):
    for found in problems(text):
        assert isinstance(found, ProgramError)
