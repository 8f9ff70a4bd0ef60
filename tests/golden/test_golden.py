"""Every golden case prints what was reviewed, by the plain lines' fast path and without it."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from trochia.languages.gcode.registry import G_CODES, M_CODES

_REWRITE = runpy.run_path(str(Path(__file__).parent / "rewrite.py"))
CASES = _REWRITE["cases"]()
render = _REWRITE["render"]


@pytest.mark.parametrize("fast", [True, False], ids=["fast", "plain"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case_prints_what_was_reviewed(case, fast):
    expected = {path.name: path.read_bytes() for path in case.glob("expected.*") if path.suffix in (".canon", ".error")}
    assert render(case, fast=fast) == expected


def test_every_code_has_a_case():
    text = "".join(
        (case / "program.ngc").read_text(encoding="latin-1").upper()
        for case in CASES
        if not (case / "expected.error").exists()
    )
    words = set(text.replace("\n", " ").split())
    codes = (code for code in (*G_CODES.values(), *M_CODES.values()) if code.group != "user code")
    missing = [code.name for code in codes if code.name not in words]
    assert not missing
