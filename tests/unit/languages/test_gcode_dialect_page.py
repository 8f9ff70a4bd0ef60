"""The reference page of dialects says what their data say, and the machine file knows them all."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

import trochia
from trochia.languages.gcode.dialects import DIALECTS
from trochia.machine.load import load
from trochia.machine.machine import DIALECTS as NAMES
from trochia.program import Dwell

PAGE = Path(__file__).parents[3] / "docs" / "reference" / "dialects.md"
TABLE = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.read_text("utf-8").split("\n")
    if line.startswith("|")
]
COLUMN = {name: column for column, name in enumerate(TABLE[0])}
ROWS = {row[0]: row for row in TABLE[2:]}
UNIT = {1.0: "s", 0.001: "ms"}


def cell(row: str, dialect) -> str:
    return ROWS[next(key for key in ROWS if key.startswith(row))][COLUMN[dialect.name]]


@pytest.mark.parametrize("dialect", DIALECTS.values(), ids=DIALECTS)
class TestPage:
    def test_the_end(self, dialect):
        assert cell("no M2", dialect) == ("error" if dialect.needs_end else "ended, warning")

    def test_the_dwell(self, dialect):
        assert cell("`G4 P`", dialect) == UNIT[dialect.dwell["p"]]
        other = {letter.upper(): unit for letter, unit in dialect.dwell.items() if letter != "p"}
        said = cell("`G4` otherwise", dialect)
        letters, _, unit = said.partition(": ")
        assert set(letters.split()) == set(other)
        assert {unit} - {""} == {UNIT[value] for value in other.values()}

    def test_unknown_codes(self, dialect):
        said = cell("unknown M code", dialect)
        assert said.startswith("error") == dialect.unknown_m
        assert said.startswith("its line") == dialect.whole_line

    def test_replaced_codes(self, dialect):
        assert ("M3" in cell("`M106", dialect)) == (106 in dialect.replaced)

    def test_mirrors(self, dialect):
        assert ("mirror" in cell("`M70`", dialect)) == (70 in dialect.mirrors)
        assert ("mirror" in cell("`M80`", dialect)) == (80 in dialect.mirrors)

    def test_codes_left_out(self, dialect):
        assert ("left out" in cell("`G10`", dialect)) == bool(dialect.left_out)
        assert {"g10", "g11", "g29"} >= set(dialect.left_out)

    def test_remarks(self, dialect):
        rows = {"m4": "`M4`", "m70": "`M70`", "m71": "`M70`", "g28": "`G28`"}
        assert set(dialect.remarks) <= set(rows)
        for code, row in rows.items():
            if code in dialect.remarks:
                assert "warning" in cell(row, dialect)

    def test_how_lines_are_written(self, dialect):
        assert ("program number" in cell("`O1234`", dialect)) == dialect.program_numbers
        assert ("left out" in cell("`*`", dialect)) == dialect.checksums
        assert ("the axis" in cell("axis without", dialect)) == dialect.bare_axes
        assert ("left out" in cell("`E`", dialect)) == ("e" in dialect.dropped_words)
        assert ("says so" in cell("`$", dialect)) == bool(dialect.refused)


def test_every_dialect_has_a_column_and_a_name_in_the_machine_file():
    assert TABLE[0][1:] == list(DIALECTS)
    assert tuple(DIALECTS) == NAMES


def test_programs_are_read_in_the_machines_dialect():
    printer = dataclasses.replace(load("reference-mill"), dialect="marlin")
    program = trochia.gcode("G4 P1500\n", printer)
    assert [action.seconds for action in program.actions if isinstance(action, Dwell)] == [1.5]
    assert not [problem for problem in trochia.check("G4 P1500\n", printer).problems if problem.severity == "error"]


def test_what_is_asked_for_comes_before_the_machine():
    printer = dataclasses.replace(load("reference-mill"), dialect="marlin")
    reading = trochia.languages.gcode.Reading(dialect=DIALECTS["fanuc"])
    program = trochia.gcode("G4 X2\n", printer, reading=reading)
    assert [action.seconds for action in program.actions if isinstance(action, Dwell)] == [2.0]
