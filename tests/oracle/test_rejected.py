"""Rejected programs: every error of ours, in other spellings, against LinuxCNC's stand-alone interpreter.

Each golden program that is at fault is written in other ways that mean the same; both must reject it, at the same line.
"""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

pytestmark = pytest.mark.oracle

HERE = Path(__file__).parent
GOLDEN = HERE.parent / "golden"
DIFFERENCES = runpy.run_path(str(HERE / "test_rs274.py"))["DIFFERENCES"]
work_of = runpy.run_path(str(GOLDEN / "rewrite.py"))["work_of"]
CASES = [
    path.parent
    for path in sorted(GOLDEN.glob("*/expected.error"))
    if path.parent.name not in DIFFERENCES and b"%" not in (path.parent / "program.ngc").read_bytes()
]
LONGEST = 200  # characters of a line that others may be added to


def _further_down(lines: list[str]) -> list[str]:
    return ["(one)", "", "; three", "#30 = 4 (four)", *lines]


def _spread(lines: list[str]) -> list[str]:
    """Blanks between all characters, where no comment forbids it."""
    return [line if set("(;") & set(line) else "  ".join(line) for line in lines]


def _shouted(lines: list[str]) -> list[str]:
    return [line if "(" in line else line.swapcase() for line in lines]


def _numbered(lines: list[str]) -> list[str]:
    return [f"N{10 * count} {line}" if line[:1].isalpha() and line[0] not in "NnOo" else line
            for count, line in enumerate(lines, start=1)]  # fmt: skip


def _remarked(lines: list[str]) -> list[str]:
    return [line if not line.strip() or set("();") & set(line) else f"{line} ; seen" for line in lines]


@pytest.mark.parametrize("spelling", [_further_down, _spread, _shouted, _numbered, _remarked])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_rejected_in_another_spelling(agree, case, spelling):
    text = (case / "program.ngc").read_bytes().decode("latin-1").replace("\r", "")
    if any(len(line) > LONGEST for line in text.split("\n")) or (not text.isprintable() and not text.isascii()):
        pytest.skip("spelt otherwise it would be another program")
    extra = {name: case / file for name, file in (("variables", "params.var"), ("tools", "tool.tbl"))}
    files = {name: path.read_text() for name, path in extra.items() if path.exists()}
    agree("\n".join(spelling(text.split("\n"))).encode("latin-1"), work=work_of(case), **files)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_rejection_names_its_place(case):
    kind, _, report = (case / "expected.error").read_text("utf-8").partition(": ")
    place = report.split(": ")[0].split(":")
    assert kind
    assert place[0] == "program.ngc"
    assert int(place[1]) >= 1
