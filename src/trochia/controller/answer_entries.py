"""A machine's answers to a program as entries of a journal, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from trochia.languages.gcode.answers import Answer, Probed, Read

if TYPE_CHECKING:
    from collections.abc import Mapping


def entry_of(answer: Answer) -> dict[str, Any]:
    """Return an answer for the journal."""
    if isinstance(answer, Read):
        return {"value": answer.value}
    return {"at": answer.at, "rest": answer.rest, "touched": answer.touched}


def answer_of(entry: Mapping[str, Any]) -> Answer:
    """Return the answer of an entry."""
    if "value" in entry:
        return Read(float(entry["value"]))
    return Probed(tuple(entry["at"]), tuple(entry["rest"]), touched=bool(entry["touched"]))
