"""The classic interpolators: a line or an arc in whole steps to the pulses of two axes; integers only.

Each method is one file, which states it readably; ``core/shared/interpolate.h`` does the same fast, and on a chip.  A
row in ``INTERPOLATORS`` is what makes a method known to the command line and tested.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.interpolate import METHODS, Begun
from trochia.pulses.interpolators import bresenham, dda, difference, octant, point
from trochia.pulses.interpolators.frame import Arc, Figure, Line, pieces
from trochia.pulses.port import PortBit

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from trochia.pulses.interpolators.frame import Point, Step


@dataclass(frozen=True, slots=True, kw_only=True)
class Interpolator:
    """One method.

    Attributes
    ----------
    name, title
        As the command line and as a plot calls it.
    line
        (p, q) to the steps of a line in the frame (``frame.py``).
    arc
        (x, y, x_end, y_end, radius²) to the steps of an arc in the frame's quadrant.
    line_bound, arc_bound
        Greatest distance from the true curve it promises [steps].
    """

    name: str
    title: str
    line: Callable[[int, int], Iterator[Step]]
    arc: Callable[[int, int, int, int, int], Iterator[Step]]
    line_bound: float
    arc_bound: float

    def begin(self, figure: Figure) -> Begun:
        """Return a figure set up in the C core."""
        method = METHODS[self.name]
        if isinstance(figure, Line):
            return Begun.line(method, figure.x, figure.y)
        return Begun.arc(method, figure.start, figure.end, figure.radius_squared, clockwise=figure.clockwise)

    def pulses(self, figure: Figure) -> NDArray[np.uint8]:
        """Return the pulse byte of each tick (ticks,), by the C core; the bits are ``PortBit``'s first four."""
        return self.begin(figure).pulses()

    def reference(self, figure: Figure) -> NDArray[np.uint8]:
        """Return the same, by the readable statement in Python."""
        parts: list[int] = []
        for steps, x_step, y_step in self.tracks(figure):
            code_x, code_y = _clock(x_step), _clock(y_step)
            way = _directions(x_step) | _directions(y_step)
            parts += [way | step_x * code_x | step_y * code_y for step_x, step_y in steps]
        return np.array(parts, dtype=np.uint8)

    def tracks(self, figure: Figure) -> Iterator[tuple[Iterator[Step], Point, Point]]:
        """Yield each piece's steps in the frame, and what a step of its x and y is on the real axes."""
        if isinstance(figure, Line):
            ways = (np.sign(figure.x), 0), (0, np.sign(figure.y))
            yield self.line(abs(figure.x), abs(figure.y)), *ways
            return
        for piece in pieces(figure):
            steps = self.arc(piece.x, piece.y, piece.x_end, piece.y_end, figure.radius_squared)
            yield steps, piece.x_step, piece.y_step


def _clock(step: Point) -> int:
    """Return the clock bit of a step's axis."""
    return int(PortBit.X_CLOCK if step[0] else PortBit.Y_CLOCK)


def _directions(step: Point) -> int:
    """Return the direction bit of a step, where it goes forwards."""
    return int(PortBit.X_FORWARDS * (step[0] > 0) | PortBit.Y_FORWARDS * (step[1] > 0))


def positions(pulses: NDArray[np.uint8], start: Point = (0, 0)) -> NDArray[np.int64]:
    """Return where the axes stand after each tick (ticks + 1, 2) [steps], the start first."""
    clocks = np.stack((pulses & PortBit.X_CLOCK, pulses & PortBit.Y_CLOCK), axis=-1) > 0
    forwards = np.stack((pulses & PortBit.X_FORWARDS, pulses & PortBit.Y_FORWARDS), axis=-1) > 0
    moves = clocks * np.where(forwards, 1, -1)
    return np.cumsum(np.concatenate((np.array([start]), moves)), axis=0, dtype=np.int64)


INTERPOLATORS: dict[str, Interpolator] = {
    row.name: row
    for row in (
        Interpolator(name="dda", title="DDA", line=dda.line, arc=dda.arc, line_bound=1.0, arc_bound=2.0),
        Interpolator(name="bresenham", title="Bresenham", line=bresenham.line, arc=bresenham.arc,
                     line_bound=0.5, arc_bound=1.0),
        Interpolator(name="point", title="Point by point", line=point.line, arc=point.arc,
                     line_bound=1.0, arc_bound=1.25),
        Interpolator(name="difference", title="Coordinate difference", line=difference.line, arc=difference.arc,
                     line_bound=1.5, arc_bound=2.0),
        Interpolator(name="octant", title="Octant function", line=octant.line, arc=octant.arc,
                     line_bound=0.5, arc_bound=1.0),
    )
}  # fmt: skip

__all__ = ["INTERPOLATORS", "Arc", "Figure", "Interpolator", "Line", "positions"]
