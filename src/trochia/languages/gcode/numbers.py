"""A number in a compact line: the one place that knows how a value is written.

In: the line without blanks, in lower case, and where the value starts.  Out: the value and where it ends.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ParseError

if TYPE_CHECKING:
    from trochia.languages.gcode.place import Place

_NUMBER = re.compile(r"[+-]*[0-9.]*")


def read_number(text: str, at: int, place: Place) -> tuple[float, int]:
    """Return the value that starts at ``at``, and the index after it.

    Digits with at most one point; any number of signs may stand before them, as RS274 reads ``--1`` as 1.

    Raises
    ------
    ParseError
        Where no number stands.
    """
    match = _NUMBER.match(text, at)
    assert match is not None  # the pattern matches nothing at all, too
    found = match.group()
    try:
        return float(found), match.end()
    except ValueError:
        digits = found.lstrip("+-")
        try:
            value = float(digits)
        except ValueError:
            raise _no_number(text, at, digits, place) from None
    return (-value if found.count("-") % 2 else value), match.end()


def _no_number(text: str, at: int, digits: str, place: Place) -> ParseError:
    """Return the error that says why no number could be read at ``at``."""
    if digits:
        return place.fault(ParseError, f"{digits!r} is no number", at, hint="A number has at most one decimal point.")
    word = text[at - 1].upper() if at else ""
    if not word.isalpha():
        return place.fault(ParseError, f"a value is missing behind {word!r}", max(at - 1, 0),
                           hint="A value is a number, #parameter, [expression] or a function: SIN[30].")  # fmt: skip
    return place.fault(ParseError, f"the word {word} has no number", at - 1, hint=f"Write a number after {word}.")


def as_integer(value: float, slack: float = 1e-4) -> int | None:
    """Return the integer within ``slack`` of ``value``, or None."""
    nearest = round(value)
    return nearest if abs(value - nearest) <= slack else None
