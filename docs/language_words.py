"""Pages of ``docs/reference/gcode/`` for what is no code: letters, O-words, functions and operators, comments that act.

In: the interpreter's tables, the golden programs.  Out: Markdown; each entry with the shortest golden program that has
it and what that prints, or the report it earns.
"""

from __future__ import annotations

import re
from pathlib import Path

from trochia.languages.gcode.block import AXIS
from trochia.languages.gcode.comments import KINDS
from trochia.languages.gcode.functions import FUNCTIONS, OPERATORS
from trochia.languages.gcode.owords import WORDS as O_WORDS
from trochia.languages.gcode.polar import POLAR
from trochia.languages.gcode.registry import G_CODES, M_CODES, WORDS

GOLDEN = Path(__file__).resolve().parents[1] / "tests" / "golden"
_COMMENT = re.compile(r"\([^()]*\)|;.*")
_O_ABOUT = {
    "sub": "begins a subroutine", "endsub": "ends it; a value behind it is #<_value>", "call": "calls it with values",
    "return": "goes back before its end", "do": "begins a loop that ends with WHILE",
    "while": "goes on as long as its value is not 0", "endwhile": "ends the loop", "repeat": "repeats so many times",
    "endrepeat": "ends the loop", "if": "goes on only if its value is not 0", "elseif": "asks another question",
    "else": "is for all other cases", "endif": "ends the branches", "break": "leaves the loop",
    "continue": "begins the next round",
}  # fmt: skip


def programs() -> dict[str, str]:
    """Return all golden programs by the name of their case; accepted ones first."""
    found = {path.parent.name: path.read_text("latin-1") for path in sorted(GOLDEN.glob("*/program.ngc"))}
    return dict(sorted(found.items(), key=lambda item: (GOLDEN / item[0] / "expected.error").exists()))


def example(pattern: str, known: dict[str, str], *, comments: bool = False) -> str | None:
    """Return the name of the shortest program that matches, one that is accepted if there is any."""
    sought = re.compile(f"(?im){pattern}")
    users = [name for name, text in known.items() if sought.search(text if comments else _COMMENT.sub("", text))]
    return min(users, key=lambda name: ((GOLDEN / name / "expected.error").exists(), len(known[name])), default=None)


def shown(name: str | None, known: dict[str, str]) -> list[str]:
    """Return a program and what becomes of it."""
    if name is None:
        return []
    wrong, right = GOLDEN / name / "expected.error", GOLDEN / name / "expected.canon"
    told = wrong.read_text("utf-8") if wrong.exists() else right.read_text("latin-1")
    does = "is refused" if wrong.exists() else "prints"
    return ["```", known[name].strip(), "```", "", does, "", "```", told.strip(), "```", ""]


def letters() -> dict[str, str]:
    """Return what each letter means."""
    found = {word.letter: f"{word.about[:1].upper()}{word.about[1:]}; acts at: {word.step}." for word in WORDS.values()}
    found |= {letter: f"Where axis {letter.upper()} goes, or by how much." for letter in AXIS}
    found |= {letter: f"{about[:1].upper()}{about[1:]}; stands for X and Y." for letter, about in POLAR.items()}
    found |= {"g": "A code of one of the groups.", "m": "A code of one of the groups.", "n": "Number of the line.",
              "o": "Label of an O-word."}  # fmt: skip
    for code in {id(code): code for code in (*G_CODES.values(), *M_CODES.values())}.values():
        for letter in code.words:
            read = found.setdefault(letter, "Read by")
            if read.startswith("Read by") and not (code.name[0] == "M" and len(code.name) == 4 and code.name > "M100"):
                found[letter] = f"{read} {'M100 to M199' if code.name == 'M100' else code.name}"
    return {letter: about if about.endswith(".") else f"{about}." for letter, about in sorted(found.items())}


def letters_page(known: dict[str, str]) -> str:
    """Return the page of letters."""
    lines = ["# Letters", ""]
    for letter, about in letters().items():
        name = example(rf"(?<![a-z<_]){re.escape(letter)}[ \t]*[-+0-9.\[#<]", known)
        lines += [f"## {letter.upper()}", "", about, "", *shown(name, known)]
    return "\n".join(lines)


def o_words_page(known: dict[str, str]) -> str:
    """Return the page of O-words."""
    lines = ["# O-words", "", "`O`, a label, and one of these; values in brackets behind it.", ""]
    for word, (least, most) in O_WORDS.items():
        values = f"{least} values" if least == most else f"{least} to {most} values"
        name = example(rf"^\s*o\s*[^\s(]*?\s*{word}\b", known)
        lines += [f"## {word.upper()}", "", f"{_O_ABOUT[word][:1].upper()}{_O_ABOUT[word][1:]}; {values}.", "",
                  *shown(name, known)]  # fmt: skip
    return "\n".join(lines)


def functions_page(known: dict[str, str]) -> str:
    """Return the page of functions and operators."""
    lines = ["# Functions and operators", "", "Angles are in degrees.", ""]
    for word in [*sorted([*FUNCTIONS, "atan", "exists"]), *OPERATORS]:
        named = word[0].isalpha()
        pattern = rf"(?<![a-z_<]){word}(?![a-z_>])" if named else rf"[0-9\])>]\s*{re.escape(word)}\s*[0-9#\[(]"
        about = f"Operator; binds with strength {OPERATORS[word][0]} of 5." if word in OPERATORS else "Function."
        lines += [f"## {word.upper()}", "", about, "", *shown(example(pattern, known), known)]
    return "\n".join(lines)


def comments_page(known: dict[str, str]) -> str:
    """Return the page of comments that act."""
    lines = ["# Comments that act", ""]
    for kind, about in KINDS.items():
        name = example(rf"\({kind}[,)]", known, comments=True)
        lines += [f"## {kind.upper()}", "", f"{about[:1].upper()}{about[1:]}.", "", *shown(name, known)]
    return "\n".join(lines)


def pages() -> dict[str, str]:
    """Return the pages by file name."""
    known = programs()
    made = {"letters": letters_page, "o-words": o_words_page, "functions": functions_page, "comments": comments_page}
    return {f"{name}.md": page(known) for name, page in made.items()}
