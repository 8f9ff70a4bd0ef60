"""Writes ``docs/reference/gcode/``: one page a modal group, from the interpreter's own tables and the golden cases.

In: the registry and ``tests/golden``.  Out: Markdown, made anew at every build of the documentation, never committed.
Every code shows the shortest golden program that uses it and what that prints, which the tests hold to be so; every
rejected golden program is an entry of the page of errors.  Letters, O-words, functions and comments: language_words.py.
"""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from typing import TYPE_CHECKING

from trochia.languages.gcode.registry import G_CODES, M_CODES, ORDER

if TYPE_CHECKING:
    from trochia.languages.gcode.codes import Code

ROOT = Path(__file__).resolve().parents[1]
GOLDEN = ROOT / "tests" / "golden"
PAGES = ROOT / "docs" / "reference" / "gcode"
WORDS_PAGES = runpy.run_path(str(ROOT / "docs" / "language_words.py"))
_COMMENT = re.compile(r"\([^()]*\)|;.*")


def programs() -> dict[str, str]:
    """Return the accepted golden programs by the name of their case."""
    found = {path.parent.name: path.read_text("latin-1") for path in sorted(GOLDEN.glob("*/program.ngc"))}
    return {name: text for name, text in found.items() if not (GOLDEN / name / "expected.error").exists()}


def example_of(code: Code, known: dict[str, str]) -> str | None:
    """Return the name of the shortest program that uses a code."""
    pattern = re.compile(rf"(?i)(?<![a-z0-9.]){code.name[0]}\s*0*{re.escape(code.name[1:])}(?![0-9.])")
    users = [name for name, text in known.items() if pattern.search(_COMMENT.sub("", text))]
    return min(users, key=lambda name: len(known[name]), default=None)


def section(code: Code, known: dict[str, str]) -> list[str]:
    """Return the entry of a code."""
    lines = [f"## {code.name}", "", f"{code.about[:1].upper()}{code.about[1:]}.", ""]
    words = " ".join(letter.upper() for letter in code.words)
    lines += [f"- acts at: {code.step} (step {ORDER.index(code.step) + 1} of {len(ORDER)})"]
    lines += [f"- words: {words}" if words else "- words: none of its own"]
    lines += ["- takes the axis words"] if code.takes_axes else []
    name = example_of(code, known)
    if name is None:
        return [*lines, ""]
    canon = (GOLDEN / name / "expected.canon").read_text("latin-1")
    return [*lines, "", "```", known[name].strip(), "```", "", "prints", "", "```", canon.strip(), "```", ""]


def group_page(group: str, codes: list[Code], known: dict[str, str]) -> str:
    """Return the page of a modal group."""
    head = [f"# {group[:1].upper()}{group[1:]}", "", "Two codes of this group cannot stand on one line.", ""]
    return "\n".join([*head, *(line for code in codes for line in section(code, known))])


def errors_page() -> str:
    """Return the page of errors, by their code names, each with the program that earns it."""
    by_kind: dict[str, list[str]] = {}
    for path in sorted(GOLDEN.glob("*/expected.error")):
        kind, _, report = path.read_text("utf-8").partition(": ")
        by_kind.setdefault(kind, []).append(f"```\n{report.strip()}\n```\n")
    lines = ["# Errors", "", "Kinds are the `code` of `check --json`.", ""]
    for kind, reports in sorted(by_kind.items()):
        lines += [f"## {kind}", "", *reports]
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """Return every page by its file name."""
    known = programs()
    groups: dict[str, list[Code]] = {}
    for code in (*G_CODES.values(), *M_CODES.values()):
        if code.name not in {other.name for other in groups.get(code.group, [])}:
            groups.setdefault(code.group, []).append(code)
    made = {f"{group.replace(' ', '-')}.md": group_page(group, codes, known) for group, codes in groups.items()}
    return {**made, **WORDS_PAGES["pages"](), "errors.md": errors_page()}


def write() -> None:
    """Write the pages, and remove those that no longer exist."""
    PAGES.mkdir(exist_ok=True)
    made = pages()
    for old in PAGES.glob("*.md"):
        if old.name not in made:
            old.unlink()
    for name, text in made.items():
        path = PAGES / name
        if not path.exists() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")
