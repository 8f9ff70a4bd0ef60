"""A line that is read once and may run many times.

In: the raw line.  Out: :class:`Template`, whose words may hold values that change; :meth:`Template.fill` makes a
:class:`Line` of plain numbers of it and lets its assignments act.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from trochia.errors import ParseError, VariableError
from trochia.languages.gcode.expression import work_out
from trochia.languages.gcode.functions import Refusal
from trochia.languages.gcode.numbers import as_integer

if TYPE_CHECKING:
    from trochia.languages.gcode.expression import Value
    from trochia.languages.gcode.owords import Control
    from trochia.languages.gcode.parameters import Parameters
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.straight import Straight

Setting = tuple[int | str, "Value", int]  #: number or name of a parameter, its value, index of the ``#``
Word = tuple[str, float, int]  #: letter in lower case, value, index of the letter in the compact line


@dataclass(slots=True)
class Line:
    """A line taken apart.  ``comment`` is the text between the last pair of brackets, leading blanks left out."""

    place: Place
    words: list[Word]
    comment: str | None


class Item(NamedTuple):
    """A word, or an assignment (letter ``#``, with what it sets); ``at`` counts in the compact line."""

    letter: str
    value: Value
    at: int
    target: Value | str = 0.0


@dataclass(slots=True)
class Template:
    """A line as it stands in the text.

    Attributes
    ----------
    items
        Words and assignments, in their order.
    fixed
        The words, where nothing on the line can change; None otherwise.
    control
        The O-word of the line (or M98, M99), which then holds nothing else.
    setting
        Number or name, value and place of the only thing on the line, where that is ``#number = value``.
    straight
        The move of a line that is nothing else, once somebody has asked for it.
    """

    place: Place
    items: list[Item]
    comment: str | None
    control: Control | None = None
    fixed: list[Word] | None = None
    setting: Setting | None = None
    straight: Straight | None = None

    def __post_init__(self) -> None:
        if len(self.items) == 1 and self.comment is None:
            self.setting = _plain_setting(self.items[0])
        if not any(item.letter == "#" or callable(item.value) for item in self.items):
            self.fixed = [(item.letter, work_out(item.value), item.at) for item in self.items]

    def set_only(self, parameters: Parameters) -> bool:
        """Let a line act that only sets a plain parameter, and return True; errors are those of :meth:`fill`."""
        setting = self.setting
        if setting is None or not parameters.is_plain(setting[0]):
            return False
        self.set(setting, parameters)
        return True

    def set(self, setting: Setting, parameters: Parameters) -> None:
        """Set a plain parameter; errors are those of :meth:`fill`."""
        key, value, at = setting
        try:
            if isinstance(key, int):
                parameters.numbered[key] = value() if callable(value) else value
            else:
                names = parameters.names_with(key)
                names[key] = value() if callable(value) else value
        except Refusal as refusal:
            raise self.place.fault(ParseError, refusal.message, at, hint=refusal.hint) from None

    def fill(self, parameters: Parameters) -> Line:
        """Return the line with its present values; assignments count from the end of the line on.

        Raises
        ------
        ParseError
            For a value that cannot be worked out.
        VariableError
            For a parameter that does not exist, has no value or cannot be set.
        """
        if self.fixed is not None:
            return Line(self.place, self.fixed, self.comment)
        words: list[Word] = []
        pending: list[tuple[int | str, float]] = []
        item: Item | None = None
        try:
            for item in self.items:
                letter, value, at, _ = item
                if letter == "#":
                    pending.append(_assignment(item, parameters))
                else:
                    words.append((letter, value() if callable(value) else value, at))
        except Refusal as refusal:
            assert item is not None
            raise self.place.fault(ParseError, refusal.message, item.at, hint=refusal.hint) from None
        except VariableError as error:
            if error.source is not None or item is None:
                raise
            raise self.place.fault(VariableError, error.message, item.at, hint=error.hint) from None
        for target, value in pending:
            _assign(target, value, parameters)
        return Line(self.place, words, self.comment)


def _plain_setting(item: Item) -> Setting | None:
    """Return an assignment to a number or name that is known."""
    target = item.target
    if item.letter != "#" or callable(target):
        return None
    return (target if isinstance(target, str) else int(target), item.value, item.at)


def _assignment(item: Item, parameters: Parameters) -> tuple[int | str, float]:
    target = item.target
    if isinstance(target, str):
        parameters.check_named(target)
        if parameters.find(target) is None:  # it exists from here on, on its own line too
            parameters.set_named(target, 0.0)
        return target, work_out(item.value)
    number = as_integer(work_out(target))
    if number is None:
        raise Refusal("the number of a parameter must be whole", "Use FIX, ROUND or FUP.")
    parameters.check(number)
    return number, work_out(item.value)


def _assign(target: int | str, value: float, parameters: Parameters) -> None:
    if isinstance(target, str):
        parameters.set_named(target, value)
    else:
        parameters.set(target, value)
