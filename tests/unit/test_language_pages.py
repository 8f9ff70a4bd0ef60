"""The generated language reference: every code has an entry with an example, every kind of error one."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from trochia.languages.gcode.registry import G_CODES, M_CODES

PAGES = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "language_pages.py"))
CODES = sorted(
    {code.name: code for code in (*G_CODES.values(), *M_CODES.values())}.values(), key=lambda code: code.name
)

OWN = [code for code in CODES if code.name[0] == "G" or float(code.name[1:]) < 100]  # M100 to M199 are all alike


@pytest.mark.parametrize("code", OWN, ids=lambda code: code.name)
def test_every_code_has_an_example_that_the_golden_cases_run(code):
    assert PAGES["example_of"](code, PAGES["programs"]()) is not None


def test_every_code_and_error_kind_has_a_section():
    made = PAGES["pages"]()
    text = "\n".join(made.values())
    assert all(f"## {code.name}\n" in text for code in CODES)
    assert all(f"## {kind}\n" in made["errors.md"] for kind in ("parse", "unknown-code", "modal-conflict"))
    assert "\n## None" not in text


WORDS_PAGES = PAGES["WORDS_PAGES"]["pages"]()
ENTRIES = [(entry.partition("\n")[0], entry) for text in WORDS_PAGES.values()
           for entry in text.split("\n## ")[1:]]  # fmt: skip
BARE = {"V"}  # the printer, whose programs these are, has six axes


def test_every_letter_word_function_and_comment_has_an_entry():
    assert {page: text.count("\n## ") for page, text in WORDS_PAGES.items()} == {
        "letters.md": 29, "o-words.md": 15, "functions.md": 29, "comments.md": 9,
    }  # fmt: skip


@pytest.mark.parametrize(("word", "entry"), ENTRIES, ids=[word for word, _ in ENTRIES])
def test_every_word_has_an_example_that_the_golden_cases_run(word, entry):
    assert word in BARE or "\nprints\n" in entry or "\nis refused\n" in entry


REJECTED = sorted(path.parent for path in (Path(__file__).parents[1] / "golden").glob("*/expected.error"))


@pytest.mark.parametrize("case", REJECTED, ids=lambda case: case.name)
def test_every_error_says_where_and_what_to_do(case):
    """The last line of a report is the remedy, set in by two blanks; the first names file and line."""
    report = (case / "expected.error").read_text("utf-8").rstrip("\n").split("\n")
    assert report[0].split(": ")[1].startswith("program.ngc:")
    assert report[-1].startswith("  ")
    assert not report[-1].startswith("    ")
