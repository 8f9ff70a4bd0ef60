"""O-words: subroutines, loops, branches; and M98, M99.  How they are written; what they do is ``flow``'s.

In: the compact line.  Out: :class:`Control`: the word, its label, and values, which are read only where the line acts:
a branch that is passed over may hold what cannot be worked out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.errors import ParseError, ProgramError, UnknownCodeError, VariableError
from trochia.languages.gcode.expression import Expressions
from trochia.languages.gcode.functions import Refusal
from trochia.languages.gcode.numbers import as_integer
from trochia.languages.gcode.parameters import ARGUMENTS

if TYPE_CHECKING:
    from trochia.languages.gcode.expression import Value
    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.template import Item

#: word -> how many values in brackets may follow it: at least, at most
WORDS = {
    "sub": (0, 0), "endsub": (0, 1), "call": (0, ARGUMENTS), "return": (0, 1), "do": (0, 0), "while": (1, 1),
    "endwhile": (0, 0), "repeat": (1, 1), "endrepeat": (0, 0), "if": (1, 1), "elseif": (1, 1), "else": (0, 0),
    "endif": (0, 0), "break": (0, 0), "continue": (0, 0),
}  # fmt: skip
GLOBAL = frozenset(("sub", "endsub", "call", "return", "", "m98", "m99"))  #: labels that are the whole program's
BARE = ""  #: a label alone begins a program that M98 calls
UNKNOWN = "?"  #: no word; a line that is passed over in a subroutine's definition may have it
_WORD = re.compile("|".join(sorted(WORDS, key=len, reverse=True)))
_NAME = re.compile(r"<([^>]*)>")
_NONE: list[float] = []  # never changed
_BY_M = {98.0: "m98", 99.0: "m99"}


@dataclass(slots=True)
class Control:
    """An O-word.

    Attributes
    ----------
    word
        As in :data:`WORDS`, or :data:`BARE`, ``m98``, ``m99``.
    label
        Name or number, as a text where it cannot change.
    at
        Index of the O in the compact line; ``text`` is that line and ``after`` where the values begin.
    values
        What stands in brackets behind it, once it has been read.
    """

    word: str
    label: str | Value
    place: Place
    at: int
    text: str = ""
    after: int = 0
    values: list[Value] | None = None
    times: Value | None = None
    spelled: str = field(default="")

    def name(self) -> str:
        """Return the label as a text."""
        label = self.label
        if isinstance(label, str):
            return label
        return _whole(self.guarded(label), self.place, self.at)

    def numbers(self, parameters: Parameters) -> list[float]:
        """Return the values behind the word.

        Raises
        ------
        ParseError
            Where too few or too many stand there, or something else.
        """
        values = self.values
        if values is None:
            values = self.values = self._read(parameters)
        return [self.guarded(value) for value in values] if values else _NONE

    def number(self, parameters: Parameters) -> float:
        """Return the only value behind the word; errors are those of :meth:`numbers`."""
        values = self.values
        if values is None:
            values = self.values = self._read(parameters)
        return self.guarded(values[0])

    def guarded(self, value: Value) -> float:
        """Return the number a value is now; what is refused becomes an error of this line."""
        try:
            return value() if callable(value) else value
        except Refusal as refusal:
            raise self.fault(ParseError, refusal.message, hint=refusal.hint) from None
        except VariableError as error:
            if error.source is not None:
                raise
            raise self.fault(VariableError, error.message, hint=error.hint) from None

    def fault(self, kind: type[ProgramError], message: str, *, hint: str | None = None) -> ProgramError:
        """Return an error that points at the O-word."""
        return self.place.fault(kind, message, self.at, hint=hint)

    def not_known(self) -> ProgramError:
        """Return the error of a word that is none of :data:`WORDS`."""
        rest = self.text[self.after :].replace("()", "")
        what = f"an O-word cannot go on like this: {rest[:12].upper()!r}"
        return self.place.fault(UnknownCodeError, what, self.after,
                                hint="Known are " + " ".join(word.upper() for word in WORDS) + ".")  # fmt: skip

    def _read(self, parameters: Parameters) -> list[Value]:
        least, most = WORDS.get(self.word, (0, 0))
        text, at = self.text, self.after
        expressions = Expressions(text, self.place, parameters)
        values: list[Value] = []
        while text[at : at + 1] == "[":
            if len(values) == most:
                raise self._superfluous(at, most)
            value, at = expressions.bracket(at)
            values.append(value)
        if len(values) < least:
            raise self.place.fault(ParseError, f"{self.word.upper()} has no value", min(at, len(text) - 1),
                                   hint=f"Write it in brackets: {self.word.upper()} [#1 LT 5].")  # fmt: skip
        if text[at : at + 2] not in ("", "()") or text[at:].strip("()"):
            raise self.place.fault(ParseError, f"{text[at].upper()!r} cannot stand behind an O-word", at,
                                   hint="Only values in brackets and comments can: use another line.")  # fmt: skip
        return values

    def _superfluous(self, at: int, most: int) -> ParseError:
        allowed = f"takes at most {most} values" if most else "takes no value"
        return self.place.fault(ParseError, f"{self.word.upper()} {allowed}", at, hint="Take the bracket away.")


def read_control(text: str, at: int, place: Place, parameters: Parameters) -> Control:
    """Return the O-word at ``at``.

    Raises
    ------
    ParseError
        For a label that is no name and no whole number.
    """
    label, end = _label(text, at, place, parameters)
    match = _WORD.match(text, end)
    if match is None and text[end:].replace("()", ""):
        return Control(UNKNOWN, label, place, at, text, end, spelled=text[at:end])
    word, after = (match.group(), match.end()) if match else (BARE, end)
    return Control(word, label, place, at, text, after, spelled=text[at:end])


def _label(text: str, at: int, place: Place, parameters: Parameters) -> tuple[str | Value, int]:
    if text[at + 1 : at + 2] == "<":
        match = _NAME.match(text, at + 1)
        if match is None:
            raise place.fault(ParseError, "the name is not closed", at, hint="Write > at its end.")
        return match.group(1), match.end()
    if len(text) == at + 1 or text[at + 1] not in "0123456789.+-#[":
        raise place.fault(ParseError, "the O-word has no label", at, hint="Write a number or a name: O100, O<name>.")
    value, end = Expressions(text, place, parameters).value(at + 1)
    return (value if callable(value) else _whole(value, place, at)), end


def _whole(value: float, place: Place, at: int) -> str:
    number = as_integer(value)
    if number is None:
        raise place.fault(ParseError, f"O{value:g}: the number of an O-word must be whole", at,
                          hint="Write it like O100.")  # fmt: skip
    return str(number)


def read_program_control(items: list[Item], place: Place) -> Control | None:
    """Return M98 or M99, where the line holds one.

    Raises
    ------
    ParseError
        Where it holds something else too, or M98 has no P.
    """
    for item in items:
        if item.letter == "m" and not callable(item.value) and item.value in _BY_M:
            return _program_control(_BY_M[item.value], item, items, place)
    return None


def _program_control(word: str, found: Item, items: list[Item], place: Place) -> Control:
    words = {item.letter: item for item in items if item is not found}
    for letter, item in words.items():
        if letter not in ("p", "l") or word == "m99":
            raise place.fault(ParseError, f"{letter.upper()} cannot stand beside {word.upper()}", item.at,
                              hint="Use another line.")  # fmt: skip
    if word == "m99":
        return Control(word, "", place, found.at, spelled=word)
    if "p" not in words:
        raise place.fault(ParseError, "M98 has no P", found.at, hint="Write the program to call: M98 P100.")
    times = words["l"].value if "l" in words else None
    label = words["p"].value
    return Control(word, label if callable(label) else _whole(label, place, words["p"].at), place, found.at,
                   times=times, spelled=word)  # fmt: skip
