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
