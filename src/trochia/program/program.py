"""A program of a million moves is columns, not a million objects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.program.actions import Action


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """Canonical moves and actions of one part program.

    Attributes
    ----------
    name
        File name, or ``<text>``.
    lines
        Number of lines of the source.
    start
        Machine position before the first move (9,) [mm, degree].
    moves
        Structured array of :data:`trochia.program.MOVE`, read-only; zero-length moves are kept.
    actions
        In order; each stands before the move ``at``.
    """

    name: str
    lines: int
    start: NDArray[np.float64]
    moves: NDArray[Any]
    actions: tuple[Action, ...]

    def __post_init__(self) -> None:
        self.start.setflags(write=False)
        self.moves.setflags(write=False)

    def starts(self) -> NDArray[np.float64]:
        """Return where each move begins (moves, 9) [mm, degree]."""
        return np.concatenate([self.start[None, :], self.moves["target"][:-1]])[: len(self.moves)]
