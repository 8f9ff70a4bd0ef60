"""A program of a million moves is columns, not a million objects."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.program.actions import Action


def _no_splines() -> NDArray[np.float64]:
    return np.zeros((0, 4, 3))


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
    splines
        Control points of cubic Bezier curves in X Y Z (k, 4, 3) [mm], read-only.  A move of kind SPLINE follows the one
        whose row its ``turns`` names; it begins where the move before ended, and ends at its own target.

    Raises
    ------
    ValueError
        When ``splines`` has another shape.
    """

    name: str
    lines: int
    start: NDArray[np.float64]
    moves: NDArray[Any]
    actions: tuple[Action, ...]
    splines: NDArray[np.float64] = field(default_factory=_no_splines)

    def __post_init__(self) -> None:
        if self.splines.shape[1:] != (4, 3) or self.splines.dtype != np.float64:
            raise ValueError("splines are control points (k, 4, 3) of doubles")
        for array in (self.start, self.moves, self.splines):
            array.setflags(write=False)

    def starts(self) -> NDArray[np.float64]:
        """Return where each move begins (moves, 9) [mm, degree]."""
        return np.concatenate([self.start[None, :], self.moves["target"][:-1]])[: len(self.moves)]
