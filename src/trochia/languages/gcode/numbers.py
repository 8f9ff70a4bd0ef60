"""A number in a compact line: the one place that knows how a value is written.

In: the line without blanks, in lower case, and where the value starts.  Out: the value and where it ends.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ParseError, UnknownCodeError

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
    UnknownCodeError
        Where a parameter or an expression stands.
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


def _no_number(text: str, at: int, digits: str, place: Place) -> ParseError | UnknownCodeError:
    """Return the error that says why no number could be read at ``at``."""
    if not digits and text[at : at + 1] in ("#", "["):
        return place.fault(UnknownCodeError, "parameters and expressions are not known here", at,
                           hint="Write the number itself.")  # fmt: skip
    if digits:
        return place.fault(ParseError, f"{digits!r} is no number", at, hint="A number has at most one decimal point.")
    word = text[at - 1].upper() if at else ""
    return place.fault(ParseError, f"the word {word} has no number", at - 1, hint=f"Write a number after {word}.")


def as_integer(value: float, slack: float = 1e-4) -> int | None:
    """Return the integer within ``slack`` of ``value``, or None."""
    nearest = round(value)
    return nearest if abs(value - nearest) <= slack else None
