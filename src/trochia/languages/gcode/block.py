"""One line as the language understands it: codes by modal group, values by letter.

In: a :class:`~trochia.languages.gcode.reader.Line`.  Out: :class:`Block`, of which everything that does not depend on
the modal state is known to be sound.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from trochia.errors import ModalConflictError, ParseError, ProgramError, UnknownCodeError
from trochia.languages.gcode.numbers import as_integer
from trochia.languages.gcode.polar import POLAR
from trochia.languages.gcode.registry import G_CODES, G_TENTH, M_CODES, MOST_M_CODES, WORDS

if TYPE_CHECKING:
    from trochia.languages.gcode.codes import Code, WordCode
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.template import Line, Word

_Error = TypeVar("_Error", bound=ProgramError)

AXIS = {letter: column for column, letter in enumerate("xyzabcuvw")}
_VALUES = frozenset("dehijklpqr$") | frozenset(POLAR) | frozenset(WORDS) | frozenset(AXIS)
_NOT_NEGATIVE = frozenset("fst")
_WHOLE = frozenset("lt")
_MOST = 2**31 - 1  # of a word that is a whole number
_USER_CODES = 1000  # tenths: from M100 on


@dataclass(slots=True)
class Block:
    """A line, sorted.

    Attributes
    ----------
    values
        Every word that is no code, by its letter.
    axes
        Axis words: column of the axis -> value.
    codes
        Codes in the order of the line; ``groups`` has them by modal group.
    acting
        Words that act by themselves.
    motion
        The motion code that acts on this line, or None; set by the check against the modal state.
    in_machine
        Targets are machine coordinates (G53).
    dropped
        What has not acted yet does not act any more (M72).
    where
        Index of each word in the compact line, by its letter or the name of its code.
    """

    place: Place
    comment: str | None
    values: dict[str, float] = field(default_factory=dict[str, float])
    axes: dict[int, float] = field(default_factory=dict[int, float])
    codes: list[Code] = field(default_factory=list["Code"])
    groups: dict[str, Code] = field(default_factory=dict[str, "Code"])
    where: dict[str, int] = field(default_factory=dict[str, int])
    acting: list[WordCode] = field(default_factory=list["WordCode"])
    motion: Code | None = None
    in_machine: bool = False
    dropped: bool = False

    @property
    def is_polar(self) -> bool:
        """Polar words stand for X and Y."""
        return "@" in self.values or "^" in self.values

    @property
    def has_target(self) -> bool:
        """The line has axis words, or polar words in their place."""
        return bool(self.axes) or self.is_polar

    @property
    def mover(self) -> str:
        """The word to point at when the line's motion is at fault: its code, or the first axis or centre word."""
        if self.motion is not None and self.motion.name in self.where:
            return self.motion.name
        movers = [letter for letter in self.values if letter in AXIS or letter in "ijkr@^"]
        return min(movers, key=self.where.__getitem__, default="")

    def fault(self, kind: type[_Error], message: str, word: str = "", *, hint: str | None = None) -> _Error:
        """Return an error of that kind that points at a word, by its letter or code (none: the whole line)."""
        return self.place.fault(kind, message, self.where.get(word), hint=hint)


def sort_words(line: Line, allowed: str) -> Block:
    """Return the line sorted into codes and values; ``allowed`` are the axis letters, in lower case.

    Raises
    ------
    ParseError
        For a word twice, a value that cannot be.
    UnknownCodeError
        For a code or word that is not known.
    ModalConflictError
        For two codes of one modal group.
    """
    block = Block(line.place, line.comment)
    for word in line.words:
        letter = word[0]
        if letter == "g":
            _add_code(block, _g_code(block, word), word)
        elif letter == "m":
            _add_code(block, _m_code(block, word), word)
        else:
            _add_value(block, word, allowed)
    return block


def _add_value(block: Block, word: Word, allowed: str) -> None:
    """Add a word that is no code."""
    letter, value, at = word
    if letter in block.values:
        raise block.place.fault(ParseError, f"the word {letter.upper()} stands twice on the line", at,
                                hint="Keep one of them.")  # fmt: skip
    if (
        letter not in _VALUES
        or (letter in AXIS and letter not in allowed)
        or (letter in POLAR and not ("x" in allowed and "y" in allowed))
    ):
        raise block.place.fault(UnknownCodeError, f"there is no word {letter.upper()} here", at,
                                hint=f"Axis words are {' '.join(allowed.upper())}.")  # fmt: skip
    if letter in _NOT_NEGATIVE and value < 0:
        raise block.place.fault(ParseError, f"{letter.upper()} must not be negative", at,
                                hint="Take the minus away.")  # fmt: skip
    if letter in _WHOLE:
        count = as_integer(value)
        if count is None or not 0 <= count <= _MOST:
            raise block.place.fault(ParseError, f"{letter.upper()} must be a whole number, 0 or more", at,
                                    hint="Use ROUND, FIX or FUP where it is worked out.")  # fmt: skip
    block.values[letter] = value
    block.where[letter] = at
    column = AXIS.get(letter)
    if column is not None:
        block.axes[column] = value
    elif letter in WORDS:
        block.acting.append(WORDS[letter])


def _add_code(block: Block, code: Code, word: Word) -> None:
    """Add a code, where its modal group is free; G80 gives way to another motion code."""
    other = block.groups.get(code.group)
    if other is not None and code.group == "motion":
        if code.name == "G80":
            return
        if other.name == "G80":
            block.codes.remove(other)
            other = None
    if other is not None:
        raise block.place.fault(ModalConflictError, f"{other.name} and {code.name} cannot stand on one line", word[2],
                                hint=f"Both belong to the modal group {code.group!r}: use two lines.")  # fmt: skip
    block.groups[code.group] = code
    block.codes.append(code)
    block.where[code.name] = word[2]


def _g_code(block: Block, word: Word) -> Code:
    """Return the G code a word names."""
    _, value, at = word
    key = as_integer(value * 10, G_TENTH)
    code = None if key is None else G_CODES.get(key)
    if code is None:
        raise block.place.fault(UnknownCodeError, f"G{value:g} is not known", at, hint=_nearby(value))
    return code


def _m_code(block: Block, word: Word) -> Code:
    """Return the M code a word names."""
    _, value, at = word
    key = as_integer(value)
    code = None if key is None else M_CODES.get(key * 10)
    if code is None:
        known = " ".join(code.name for key, code in M_CODES.items() if key < _USER_CODES)
        raise block.place.fault(UnknownCodeError, f"M{value:g} is not known", at,
                                hint=f"Known are {known}.")  # fmt: skip
    if sum(code.name[0] == "M" for code in block.codes) == MOST_M_CODES:
        raise block.place.fault(ModalConflictError, f"more than {MOST_M_CODES} M codes on one line", at,
                                hint="Use two lines.")  # fmt: skip
    return code


def _nearby(value: float) -> str:
    """Return the known G codes that look like ``value``, as a hint."""
    same = [code.name for key, code in G_CODES.items() if key // 10 == int(value)]
    return "Known are " + " ".join(same or (code.name for code in G_CODES.values())) + "."
