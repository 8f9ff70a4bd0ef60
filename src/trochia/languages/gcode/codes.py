"""What a code is: a row of the language's tables.

A code acts when its step of :data:`trochia.languages.gcode.registry.ORDER` comes, whatever its place on the line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

Handler = Callable[["Block", "State", "Sink"], None]
Check = Callable[["Block", "State"], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Code:
    """A G or M code.

    Attributes
    ----------
    name
        As written: ``G1``, ``G59.3``, ``M3``.
    about
        What it does, in a few words.
    group
        Modal group: two codes of one group cannot stand on a line.
    step
        When it acts, by the order of execution.
    run
        What it does.
    words
        Letters it reads, beside axis words and F, S, T.
    takes_axes
        It takes the axis words, so that no motion code can stand beside it.
    check
        For a motion code and G10: refuses a line that is wrong before anything on it acts.
    """

    name: str
    about: str
    group: str
    step: str
    run: Handler
    words: str = ""
    takes_axes: bool = False
    check: Check | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class WordCode:
    """A word that acts by itself: F, S, T."""

    letter: str
    about: str
    step: str
    run: Handler


def key_of(number: float) -> int:
    """Return a code number in tenths, as the tables are keyed: 59.3 is 593."""
    return round(number * 10)


def table(*codes: Code) -> dict[int, Code]:
    """Return the codes by their number in tenths."""
    return {key_of(float(code.name[1:])): code for code in codes}
