"""Where in the text a line stands, and errors that point into it.

In: the raw line.  Out: :class:`Place`, which turns an index into the compact line (no blanks, each comment shortened
to ``()``) into a column of the raw line, when and only when an error needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from trochia.errors import ProgramError, Source

_Error = TypeVar("_Error", bound=ProgramError)

BLANKS = b" \t\r\n"


def column_of(raw: bytes, index: int) -> int:
    """Return the column, from 1, of the character with that index in the compact form of ``raw``."""
    at = seen = 0
    while at < len(raw):
        if raw[at : at + 1] in (b" ", b"\t", b"\r", b"\n"):
            at += 1
            continue
        if seen >= index:
            break
        if raw[at : at + 1] == b"(":  # a comment counts two, its brackets
            close = raw.find(b")", at)
            at, seen = (close + 1 if close >= 0 else len(raw)), seen + 2
            continue
        at, seen = at + 1, seen + 1
    return at + 1


@dataclass(slots=True)
class Place:
    """One line of a named text."""

    file: str
    line: int
    raw: bytes

    def fault(self, kind: type[_Error], message: str, index: int | None = None, *, hint: str | None = None) -> _Error:
        """Return an error of that kind at this line; ``index`` counts in the compact line (None: the whole line)."""
        column = 0 if index is None else column_of(self.raw, index)
        text = self.raw.decode("latin-1") if self.raw else None
        return kind(message, source=Source(self.file, self.line, column), text=text, hint=hint)
