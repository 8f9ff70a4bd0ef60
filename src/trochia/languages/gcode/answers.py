"""What a machine has answered to a program that asks it: where a probe switched, what an input read.

In: the answers so far, in the order in which the program asked.  Out: they are given one after another; the first
question without an answer ends the reading, and whoever runs the program reads it again with one answer more.

A program reads alike each time, so what was executed before a question is what stands before it then.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.languages.gcode.frames import to_program

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.state import State

PROBED = 5061  #: variables of the point probed, nine; then whether it switched
TOUCHED = 5070
KEPT = range(PROBED, TOUCHED + 1)  #: a live controller keeps them from one program to the next

Point = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Probed:
    """The answer to a probing move: where the probe switched, where the machine came to rest (9) [mm, degree].

    Where it did not switch (``touched`` is False) both are where the move ended.
    """

    at: Point
    rest: Point
    touched: bool = True


@dataclass(frozen=True, slots=True)
class Read:
    """The answer to M66: 0 or 1, the value of an analogue input, or -1 where the time was over."""

    value: float


Answer = Probed | Read


class Answers:
    """The answers to one reading of a program.

    Attributes
    ----------
    wanting
        Whether the reading ended at a question without an answer.
    """

    def __init__(self, given: tuple[Answer, ...]) -> None:
        self._given = given
        self._next = 0
        self.wanting = False

    def take(self) -> Answer | None:
        """Return the next answer; None ends the reading."""
        if self._next >= len(self._given):
            self.wanting = True
            return None
        self._next += 1
        return self._given[self._next - 1]


def stop_reading(block: Block, state: State) -> None:
    """End the program here: nobody knows yet how it goes on."""
    block.dropped = True
    state.ended = True


def note_probed(state: State, answer: Probed) -> None:
    """Let the program stand where the machine does, and find the point probed in its variables."""
    state.parameters.fill(PROBED, to_program(state, answer.at))
    state.parameters.numbered[TOUCHED] = float(answer.touched)
    state.position = to_program(state, answer.rest)
