"""One line of text to words.

In: the raw bytes of a line.  Out: :class:`Line`: words in their order (letter, value, index into the
compact line), and the last comment.  Nothing here knows what a word means.

RS274 reads a line without its blanks and without regard to case; ``( )`` and ``;`` hold comments.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from trochia.errors import ParseError, UnknownCodeError
from trochia.languages.gcode.numbers import read_number
from trochia.languages.gcode.place import BLANKS, Place

LONGEST_LINE = 252  #: characters a line may have, its end not counted

Word = tuple[str, float, int]  #: letter in lower case, value, index of the letter in the compact line

_LINE_NUMBER = re.compile(r"n[0-9]+(?:\.[0-9]+)?")
_COMMENT = re.compile(rb"\(([^()]*)\)")
_LATER = {"#": "parameters", "o": "subroutines and loops (O-words)", "@": "polar words", "^": "polar words",
          "$": "spindle numbers", "[": "expressions"}  # fmt: skip
_HINTS = {
    "/": "Block delete stands at the beginning of the line.",
    "n": "A line number is the first word of its line: N10.",
    "%": "A line % ends a program only if the program begins with one.",
    ")": "There is no ( before it.",
    "\xef": "Save the file without a byte order mark.",
}


@dataclass(slots=True)
class Line:
    """A line taken apart.  ``comment`` is the text between the last pair of brackets, leading blanks left out."""

    place: Place
    words: list[Word]
    comment: str | None


def read_line(place: Place) -> Line:
    """Return the words and the comment of a line.

    Raises
    ------
    ParseError
        For a comment that is not closed or nested, a character that begins no word, a word without a number.
    UnknownCodeError
        For a word this release does not have.
    """
    raw = place.raw.rstrip()
    if len(place.raw.rstrip(b"\n")) > LONGEST_LINE:
        raise place.fault(ParseError, f"the line is longer than {LONGEST_LINE} characters",
                          hint="Break it, or shorten the comment.")  # fmt: skip
    comment = None
    if b"(" in raw or b";" in raw:
        raw, comment = _without_comments(raw, place)
    text = raw.translate(None, BLANKS).lower().decode("latin-1")
    at = 1 if text[:1] == "/" else 0  # block delete is off, or the line would not be read
    number = _LINE_NUMBER.match(text, at)
    return Line(place, _words(text, number.end() if number else at, place), comment)


def _words(text: str, at: int, place: Place) -> list[Word]:
    """Return the words of the compact line from ``at`` on."""
    words: list[Word] = []
    size = len(text)
    while at < size:
        letter = text[at]
        if letter == "(":
            at += 2
            continue
        if not "a" <= letter <= "z" or letter in "no":
            raise _bad_character(letter, at, place)
        value, end = read_number(text, at + 1, place)
        words.append((letter, value, at))
        at = end
    return words


def _bad_character(letter: str, at: int, place: Place) -> ParseError | UnknownCodeError:
    """Return the error for a character that begins no word."""
    if letter in _LATER:
        return place.fault(UnknownCodeError, f"{letter.upper()!r}: {_LATER[letter]} are not known here", at)
    hint = "A number stands behind its letter." if letter in ".+-0123456789" else _HINTS.get(letter)
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
