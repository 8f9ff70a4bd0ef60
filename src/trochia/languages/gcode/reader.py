"""One line of text to words.

In: the raw bytes of a line.  Out: a :class:`~trochia.languages.gcode.template.Template`: words and assignments in
their order, the last comment, and the O-word.  Nothing here knows what a word means.

RS274 reads a line without its blanks and without regard to case; ``( )`` and ``;`` hold comments.
"""

from __future__ import annotations

import re

from trochia.errors import ParseError
from trochia.languages.gcode.expression import Expressions
from trochia.languages.gcode.owords import read_control, read_program_control
from trochia.languages.gcode.parameters import Parameters
from trochia.languages.gcode.place import BLANKS, Place
from trochia.languages.gcode.template import Item, Line, Template

LONGEST_LINE = 252  #: characters a line may have, its end not counted

_LINE_NUMBER = re.compile(r"n[0-9]+(?:\.[0-9]+)?")
_COMMENT = re.compile(rb"\(([^()]*)\)")
_HINTS = {
    "/": "Block delete stands at the beginning of the line.",
    "n": "A line number is the first word of its line: N10.",
    "o": "An O-word stands first on its line.",
    "[": "A value stands behind its word: X[1 + 2].",
    "=": "A value is set like #1 = 2.",
    "%": "A line % ends a program only if the program begins with one.",
    ")": "There is no ( before it.",
    "\xef": "Save the file without a byte order mark.",
}


def read_line(place: Place, parameters: Parameters | None = None) -> Line:
    """Return the words and the comment of a line, with the values it has now; errors are those of its parts."""
    store = parameters or Parameters()
    return read_template(place, store).fill(store)


def read_template(place: Place, parameters: Parameters) -> Template:
    """Return a line taken apart.

    Raises
    ------
    ParseError
        For a comment that is not closed or nested, a character that begins no word, a word without a number.
    """
    raw, comment = check_comments(place)
    text = raw.translate(None, BLANKS).lower().decode("latin-1")
    at = 1 if text[:1] == "/" else 0  # block delete is off, or the line would not be read
    number = _LINE_NUMBER.match(text, at)
    at = number.end() if number else at
    if text[at : at + 1] == "o":
        return Template(place, [], comment, read_control(text, at, place, parameters))
    items = _items(text, at, Expressions(text, place, parameters), place)
    return Template(place, items, comment, read_program_control(items, place))


def check_comments(place: Place) -> tuple[bytes, str | None]:
    """Return the line with each comment shortened to ``()``, and the last comment.

    Raises
    ------
    ParseError
        For a line that is too long, and a comment that is not closed or nested.
    """
    raw = place.raw.rstrip()
    if len(place.raw.rstrip(b"\n")) > LONGEST_LINE:
        raise place.fault(ParseError, f"the line is longer than {LONGEST_LINE} characters",
                          hint="Break it, or shorten the comment.")  # fmt: skip
    if b"(" in raw or b";" in raw:
        return _without_comments(raw, place)
    return raw, None


def _items(text: str, at: int, expressions: Expressions, place: Place) -> list[Item]:
    """Return the words and assignments of the compact line from ``at`` on."""
    items: list[Item] = []
    size = len(text)
    while at < size:
        letter = text[at]
        if letter == "(":
            at += 2
        elif letter == "#":
            item, at = _assignment(text, at, expressions, place)
            items.append(item)
        elif not ("a" <= letter <= "z" or letter in "$@^") or letter in "no":
            raise _bad_character(letter, at, place)
        else:
            value, end = expressions.value(at + 1)
            items.append(Item(letter, value, at))
            at = end
    return items


def _assignment(text: str, at: int, expressions: Expressions, place: Place) -> tuple[Item, int]:
    """Return the assignment whose ``#`` stands at ``at``, and where it ends."""
    target, end = expressions.target(at)
    if text[end : end + 1] != "=":
        raise place.fault(ParseError, "= is missing behind the parameter", at, hint="Write it like #1 = 2.")
    value, after = expressions.value(end + 1)
    return Item("#", value, at, target), after


def _bad_character(letter: str, at: int, place: Place) -> ParseError:
    """Return the error for a character that begins no word."""
    number = letter in ".+-0123456789"
    hint = "A number stands behind its letter." if number else _HINTS.get(letter, "Take it out, or into a comment.")
    return place.fault(ParseError, f"{letter.upper()!r} begins no word", at, hint=hint)


def _without_comments(raw: bytes, place: Place) -> tuple[bytes, str | None]:
    """Return the line with each comment shortened to ``()``, and the text of the last one (None where it is empty)."""
    kept: list[bytes] = []
    last: bytes | None = None
    at = 0
    while at < len(raw):
        opening, semicolon = raw.find(b"(", at), raw.find(b";", at)
        if semicolon >= 0 and (opening < 0 or semicolon < opening):
            kept.append(raw[at:semicolon])
            break
        if opening < 0:
            kept.append(raw[at:])
            break
        match = _COMMENT.match(raw, opening)
        if match is None:
            raise _open_comment(raw, opening, place)
        kept.append(raw[at:opening] + b"()")
        last = match.group(1)
        at = match.end()
    return b"".join(kept), last.lstrip(BLANKS).decode("latin-1") if last else None


def _open_comment(raw: bytes, opening: int, place: Place) -> ParseError:
    """Return the error for a comment that is not closed, or opened twice."""
    nested = b")" in raw[opening:]
    error = place.fault(ParseError, "a comment stands in a comment" if nested else "the comment is not closed",
                        hint="Use no ( inside a comment." if nested else "Write ) at its end.")  # fmt: skip
    assert error.source is not None
    column = raw.find(b"(", opening + 1) + 1 if nested else opening + 1
    return ParseError(error.message, source=type(error.source)(place.file, place.line, column), text=error.text,
                      hint=error.hint)  # fmt: skip
