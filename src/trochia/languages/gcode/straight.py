"""Straight moves that run many times: the block of ``G1 X#1 Y[#2 + 1]``, sorted once and filled again each time.

In: a template.  Out: :class:`Straight`, or None where the line holds anything but G0 or G1 and axis words.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ParseError
from trochia.languages.gcode.block import AXIS, Block
from trochia.languages.gcode.check import check
from trochia.languages.gcode.functions import Refusal
from trochia.languages.gcode.groups.compensation import run_compensated
from trochia.languages.gcode.registry import G_CODES
from trochia.program.modes import TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.codes import Code
    from trochia.languages.gcode.expression import Value
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State
    from trochia.languages.gcode.template import Item, Template

_TENTHS = {0.0: 0, 1.0: 10}


class Straight:
    """The block of a straight move; ``words`` are letter, column, value and place of its axis words."""

    __slots__ = ("_block", "_code", "_words")

    def __init__(self, block: Block, code: Code | None, words: list[tuple[str, int, Value, int]]) -> None:
        self._block = block
        self._code = code
        self._words = words

    def run(self, state: State, sink: Sink) -> bool:
        """Make the move and return True, or False where the present modes ask for the whole way.

        Raises
        ------
        ProgramError
            As the whole way would.
        """
        code = self._code or G_CODES.get(state.motion)
        if code is None or code.name not in ("G0", "G1"):
            return False
        if state.compensation is None and not state.diameter and (code.name == "G0" or self._feeds(state)):
            self._go(code, state, sink)
            return True
        block = self._block
        for (letter, column, _, _), value in zip(self._words, self._values(), strict=True):
            block.values[letter] = block.axes[column] = value
        check(block, state)
        if state.compensation is None:
            code.run(block, state, sink)
        else:
            run_compensated(code, block, state, sink)
        return True

    @staticmethod
    def _feeds(state: State) -> bool:
        """Return whether the feed is one that no rule refuses."""
        return state.feed != 0.0 and state.law is TimeLaw.PER_SECOND

    def _go(self, code: Code, state: State, sink: Sink) -> None:
        """Make the move where no rule can refuse it: as its handler does, without a block."""
        end = state.position.copy()
        at = 0
        try:
            if state.absolute:
                for _, column, value, at in self._words:  # noqa: B007 - the error below names it
                    end[column] = value() if callable(value) else value
            else:
                for _, column, value, at in self._words:  # noqa: B007 - likewise
                    end[column] += value() if callable(value) else value
        except Refusal as refusal:
            raise self._refused(refusal, at) from None
        if code.name == "G1":
            sink.straight_feed(end)
            state.motion = 10
        else:
            sink.straight_traverse(end)
            state.motion = 0
        state.position = end
        state.straight_next = False

    def _values(self) -> list[float]:
        values: list[float] = []
        at = 0
        try:
            for _, _, value, at in self._words:  # noqa: B007 - likewise
                values.append(value() if callable(value) else value)
        except Refusal as refusal:
            raise self._refused(refusal, at) from None
        return values

    def _refused(self, refusal: Refusal, at: int) -> ParseError:
        return self._block.place.fault(ParseError, refusal.message, at, hint=refusal.hint)


def straight_of(template: Template, allowed: str) -> Straight | None:
    """Return the straight move of a line, where it is nothing else; ``allowed`` are the axis letters."""
    if template.comment is not None or template.control is not None:
        return None
    block = Block(template.place, None)
    code: Code | None = None
    words: list[tuple[str, int, Value, int]] = []
    for item in template.items:
        if item.letter == "g":
            found = _motion(item)
            if found is None or code is not None:
                return None
            code = found
            block.codes.append(code)
            block.groups[code.group] = code
            block.where[code.name] = item.at
        elif item.letter in AXIS and item.letter in allowed and item.letter not in block.where:
            words.append((item.letter, AXIS[item.letter], item.value, item.at))
            block.where[item.letter] = item.at
        else:
            return None
    return Straight(block, code, words) if words else None


def _motion(item: Item) -> Code | None:
    tenths = None if callable(item.value) else _TENTHS.get(item.value)
    return None if tenths is None else G_CODES[tenths]
