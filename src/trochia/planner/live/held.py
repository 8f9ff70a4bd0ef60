"""Moves in hand of a program that comes in blocks.  In: blocks' moves.  Out: those from one move to another, in a row.

Moves of one block are looked at where they lie; only those of several are copied together.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from trochia.planner.live.rows import joined

if TYPE_CHECKING:
    from numpy.typing import NDArray


_FEW = 2  #: parts that are kept as they are: the end of a long block, and the beginning of the next


class Held:
    """Moves ``base`` up to ``end`` of a program.

    Attributes
    ----------
    base, end
        Number of the first move in hand, and of that after the last.
    """

    __slots__ = ("_parts", "base", "end")

    def __init__(self) -> None:
        self._parts: list[tuple[NDArray[Any], int, int]] = []  # moves first up to end of an array
        self.base = self.end = 0

    @classmethod
    def of(cls, moves: NDArray[Any], base: int) -> Held:
        """Return moves in hand of which the first has a number."""
        held = cls()
        held.take(moves, 0, len(moves))
        held.base, held.end = base, base + len(moves)
        return held

    def take(self, moves: NDArray[Any], first: int, end: int) -> None:
        """Take the moves ``first`` up to ``end`` of an array as the next ones."""
        self.end += end - first
        if self._parts and self._parts[-1][0] is moves and self._parts[-1][2] == first:
            first = self._parts.pop()[1]
        self._parts.append((moves, first, end))

    def since(self, number: int) -> NDArray[Any]:
        """Return the moves from one in hand on."""
        if len(self._parts) > 1:
            whole = joined([moves[first:end] for moves, first, end in self._parts])
            if len(self._parts) > _FEW:
                self._parts = [(whole, 0, len(whole))]
            return whole[number - self.base :]
        moves, _, end = self._parts[0]
        return moves[end - (self.end - number) : end]

    def drop(self, number: int) -> None:
        """Drop the moves before one in hand."""
        while self._parts and self.base + self._parts[0][2] - self._parts[0][1] <= number:
            _, first, end = self._parts.pop(0)
            self.base += end - first
        if self._parts:
            moves, first, end = self._parts[0]
            self._parts[0] = (moves, first + number - self.base, end)
        self.base = number
