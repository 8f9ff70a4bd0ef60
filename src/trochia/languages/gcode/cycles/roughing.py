"""Levels of a lathe's roughing cycle: how the tool clears a contour, pass by pass.

In: the way from the start into the contour and along it, as segments in a frame whose first axis is the direction of
the passes and whose second one leads away from the part.  Out: moves in that frame.

A segment that leads down into the part is cut on the way: at every level the tool feeds straight over to where the
contour comes up again, leaves it at 45 degrees, goes back by a rapid and on down.  What leads up is followed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import sqrt
from typing import TYPE_CHECKING

from trochia.geometry.segments import NEAR, Segment

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from trochia.geometry.segments import Vector

_NEAR_START, _NEAR_END = (
    1e-3,
    1e-4,
)  # an arc whose highest point lies so near to an end has it there, as in the reference
MOST_LEVELS = 10_000  #: of one cycle, where the reference has no bound


@dataclass(frozen=True, slots=True)
class Move:
    """A rapid, a feed move, or an arc (its centre and sense)."""

    end: Vector
    rapid: bool = False
    centre: Vector | None = None
    sense: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Roughing:
    """How deep a pass cuts, how far it retracts, and which pockets it clears.

    ``pockets`` is 0 for all of the contour (G71), 1 for what comes before the first pocket's end (G71.1), 2 for the
    others (G71.2).
    """

    increment: float
    retract: float
    pockets: int

    def moves(self, path: Sequence[Segment]) -> Iterator[Move]:
        """Yield the moves along a path, whose first segment leads from the start to the contour.

        Raises
        ------
        ValueError
            For more levels than any part has.
        """
        pieces = [piece for segment in path for piece in _split_at_top(segment)]
        top = pieces[0].start[1]
        first = next((index for index, piece in enumerate(pieces) if not _descends(piece)), len(pieces))
        cuts = self.pockets != 2
        for index in range(first):
            yield from self._down(pieces, index, top if cuts else None)
        if self.pockets == 1:
            yield from _climb(pieces[first:])
            return
        top = top if cuts else None
        for index in range(first, len(pieces)):
            piece = pieces[index]
            if not _descends(piece):
                yield _along(piece)
                continue
            if self.pockets and (top is None or piece.start[1] > top + NEAR):
                top = piece.start[1]
            yield from self._down(pieces, index, top)

    def _down(self, pieces: Sequence[Segment], index: int, top: float | None) -> Iterator[Move]:
        """Follow a segment that leads down, and cut at its levels, which count from ``top`` (None: no levels)."""
        rest, rapid = pieces[index], index == 0
        for level in () if top is None else self._levels(pieces[index], top):
            point = _crossing(rest, level, rising=False)
            if rest.centre is None or abs(point[0] - rest.start[0]) > NEAR:
                yield _along(replace(rest, end=point), rapid=rapid)
            rest = replace(rest, start=point)
            target = _ahead(pieces, index, point)
            if target is not None and target[0] - point[0] > NEAR:
                yield from self._cut(point, target, rapid=rapid)
        if not rest.is_point or rest.centre is None:
            yield _along(rest, rapid=rapid)

    def _levels(self, piece: Segment, top: float) -> Iterator[float]:
        high, low = min(piece.start[1], top), _lowest(piece)
        first, last = (top - high) / self.increment, (top - low) / self.increment
        if last > MOST_LEVELS:
            raise ValueError(f"more than {MOST_LEVELS} passes")
        for count in range(max(int(first) - 1, 0), int(last) + 2):
            level = top - count * self.increment
            if low + NEAR < level <= high + NEAR:
                yield level

    def _cut(self, point: Vector, target: Vector, *, rapid: bool) -> Iterator[Move]:
        """Yield a pass at a level: over to the target, off it, back."""
        half = 0.5 * (target[0] - point[0])
        away = self.retract if 0.0 <= self.retract <= half else half
        level = point[1] + away
        yield Move(target)
        yield Move((target[0] - away, level), rapid=True)
        yield Move((point[0] + away, level), rapid=True)
        yield Move(point, rapid=rapid)


def _climb(pieces: Sequence[Segment]) -> Iterator[Move]:
    """Follow what rises above all before it, and feed straight over the pockets between."""
    if not pieces:
        return
    level = pieces[0].start[1]
    for piece in pieces:
        if piece.end[1] < level - NEAR or (_descends(piece) and piece.centre is None):
            continue
        point = _crossing(piece, level, rising=True)
        yield Move(point)
        rest = replace(piece, start=point)
        if piece.centre is None or not rest.is_point:
            yield _along(rest)
        level = piece.end[1]


def _split_at_top(segment: Segment) -> list[Segment]:
    """Return an arc in two where its highest point lies within it."""
    if segment.centre is None:
        return [segment]
    top = segment.centre[0], segment.centre[1] + segment.radius
    ends = ((segment.start, _NEAR_START), (segment.end, _NEAR_END))
    if not segment.holds(top) or any(abs(end[0] - top[0]) <= near and end[1] > segment.centre[1] for end, near in ends):
        return [segment]
    return [replace(segment, end=top), replace(segment, start=top)]


def _lowest(piece: Segment) -> float:
    low = min(piece.start[1], piece.end[1])
    if piece.centre is not None and piece.holds((piece.centre[0], piece.centre[1] - piece.radius)):
        low = min(low, piece.centre[1] - piece.radius)
    return low


def _descends(piece: Segment) -> bool:
    return _lowest(piece) < piece.start[1] - NEAR


def _crossing(piece: Segment, level: float, *, rising: bool) -> Vector:
    """Return where a segment passes a level on its way up or down."""
    if piece.centre is None:
        climb = piece.end[1] - piece.start[1]
        share = (level - piece.start[1]) / climb if abs(climb) > NEAR else 0.0
        share = min(max(share, 0.0), 1.0)
        return piece.start[0] + share * (piece.end[0] - piece.start[0]), level
    across = sqrt(max(piece.radius * piece.radius - (level - piece.centre[1]) * (level - piece.centre[1]), 0.0))
    points = [(piece.centre[0] + side * across, level) for side in (-1, 1)]
    held = [point for point in points if piece.holds(point)] or [piece.end if rising else piece.start]
    return held[-1 if rising else 0]


def _ahead(pieces: Sequence[Segment], index: int, point: Vector) -> Vector | None:
    """Return where the contour comes up to the level of a point again; None: nowhere."""
    level = point[1]
    for number in range(index, len(pieces)):
        piece = pieces[number]
        if piece.end[1] >= level - NEAR and (number > index or piece.centre is not None):
            return _crossing(piece, level, rising=True)
    return None


def _along(piece: Segment, *, rapid: bool = False) -> Move:
    return Move(piece.end, rapid=rapid, centre=piece.centre, sense=piece.sense)
