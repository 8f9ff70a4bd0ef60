"""One report for a user's mistake: place, line, caret, remedy."""

from __future__ import annotations

import pytest

from trochia import errors
from trochia.errors import ParseError, Source, TrochiaError


def test_report_points_at_the_word():
    error = ParseError("no such word 'Q'", source=Source("part.ngc", 3, 7), text="G1 X1\tQ2\r\n", hint="Remove it.")
    assert str(error).splitlines() == [
        "part.ngc:3:7: no such word 'Q'",
        "    G1 X1 Q2",
        "          ^",
        "  Remove it.",
    ]


def test_a_whole_line_has_no_caret():
    error = ParseError("too long", source=Source("part.ngc", 3), text="G1")
    assert str(error) == "part.ngc:3: too long\n    G1"


def test_every_error_has_its_own_code():
    kinds = [k for k in vars(errors).values() if isinstance(k, type) and issubclass(k, TrochiaError)]
    assert len({k.code for k in kinds}) == len(kinds)


@pytest.mark.parametrize("name", ["ParseError", "UnknownCodeError", "ModalConflictError", "VariableError"])
def test_program_errors_are_the_programs_fault(name: str):
    assert issubclass(getattr(errors, name), errors.ProgramError)
