"""The part of the program builder that takes what is more than one plain move: splines, threads, probing, cycles.

In: canonical calls.  Out: rows and actions of :class:`~trochia.languages.gcode.builder.Builder`, which inherits this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import ProgramError, Source
from trochia.geometry.cubics import cubics, lengths
from trochia.geometry.nurbs import Nurbs
from trochia.program import MoveKind, PathMode, Probe, SpindleLock, TimeLaw, Unfinished

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.kernels.placement import Placement
    from trochia.languages.gcode.sink import Position
    from trochia.program import Action

SPLINE_TOLERANCE = 1e-4  #: mm by which the cubics of a rational curve may leave it
_NO_CENTRE = (0.0, 0.0)
_FARTHEST = 1e100  # whose square is still a number


def require_finite(moves: NDArray[Any], name: str) -> None:
    """Raise a ProgramError where a move ends beyond what a number can hold."""
    wrong = ~np.isfinite(moves["target"]).all(axis=1)
    if wrong.any():
        raise _not_finite(name, int(moves["line"][wrong.argmax()]))


def _not_finite(name: str, line: int) -> ProgramError:
    return ProgramError("this move would end at a point that is not finite", source=Source(name, line),
                        hint="Check the numbers it is made of.")  # fmt: skip


class SpecialMoves:
    """Splines, moves locked to the spindle, probing, and the path mode of canned cycles."""

    line: int
    _name: str
    _placement: Placement
    _actions: list[Action]
    _direction: int
    _speed: float | None
    _unlocked: tuple[int, float, float, int] | None  # law, feed, its unit, path mode before a lock
    _splines: list[NDArray[np.float64]]  # control points, machine coordinates
    _kept_path: tuple[PathMode, list[float]]

    @property
    def _at(self) -> int:
        """Return the index of the next move."""
        raise NotImplementedError

    def _add(self, kind: MoveKind, target: Position, centre: tuple[float, float], turns: int) -> None:
        """Keep a row."""
        raise NotImplementedError

    def _flush(self) -> None:
        """Convert the rows gathered so far."""
        raise NotImplementedError

    def _turn_spindle(self, direction: int) -> None:
        """Turn the spindle that way at the speed in force."""
        raise NotImplementedError

    def begin_exact_path(self) -> None:
        """Keep to the path, and remember how it was followed."""
        self._flush()
        placement = self._placement
        self._kept_path = PathMode(placement.path_mode), list(placement.tolerance)
        placement.path_mode, placement.tolerance = PathMode.EXACT_PATH, [0.0, 0.0]

    def end_exact_path(self, mode: PathMode, tolerance: float, along: float) -> None:
        """Follow the path as before."""
        del mode, tolerance, along
        self._flush()
        self._placement.path_mode, self._placement.tolerance = self._kept_path

    def nurbs_feed(self, points: Sequence[tuple[float, float, float]], order: int, target: Position) -> None:
        """Take a curve as the cubics it is, or, where it is none, as cubics within :data:`SPLINE_TOLERANCE`."""
        placement = self._placement
        if max(abs(number) for point in points for number in point) > _FARTHEST:
            raise _not_finite(self._name, self.line)
        curve = Nurbs(np.array(points), order)
        pieces = cubics(curve.at, curve.spans, SPLINE_TOLERANCE / placement.scale)
        pieces = pieces[(pieces != pieces[:, :1]).any(axis=(1, 2))]
        self._flush()
        feed, size = placement.feed, lengths(pieces)
        rows = self._keep_splines(pieces, target)
        for row, (piece, length) in enumerate(zip(pieces, size, strict=True)):
            end = target if row == len(pieces) - 1 else [*piece[-1].tolist(), *target[2:]]
            if placement.law == TimeLaw.INVERSE:
                placement.feed = feed * float(size.sum() / length)
            self._add(MoveKind.SPLINE, end, _NO_CENTRE, rows + row)
        self._flush()
        placement.feed = feed

    def _keep_splines(self, pieces: NDArray[np.float64], target: Position) -> int:
        """Keep control points (k, 4, 2) of the program as those of the machine; return the row of the first."""
        placement, rows = self._placement, sum(map(len, self._splines))
        shift, origin = np.array(list(placement.shift)), np.array(list(placement.origin))
        across, up = np.moveaxis(pieces + shift[:2], 2, 0)
        machine = np.empty((*pieces.shape[:2], 3))
        machine[..., 0] = placement.cosine * across - placement.sine * up + origin[0]
        machine[..., 1] = placement.sine * across + placement.cosine * up + origin[1]
        machine[..., 2] = target[2] + shift[2] + origin[2]
        self._splines.append(machine * placement.scale)
        return rows

    def set_spline_time(self, per_minute: float) -> None:
        """Let the next curve last 1/F minutes."""
        self._placement.feed = per_minute

    def start_synchronised(self, pitch: float) -> None:
        """Use a feed per turn of the spindle, keep to the path, and begin at rest."""
        self._flush()
        placement = self._placement
        if self._unlocked is None:
            self._unlocked = (placement.law, placement.feed, placement.feed_scale, placement.path_mode)
            self._actions.append(SpindleLock(at=self._at, line=self.line, pitch=pitch * placement.scale))
        placement.law, placement.path_mode = TimeLaw.PER_REV, PathMode.EXACT_PATH
        placement.feed, placement.feed_scale = pitch, placement.scale

    def stop_synchronised(self) -> None:
        """Use the feed as before, and begin at rest."""
        self._flush()
        placement = self._placement
        if self._unlocked is not None:
            placement.law, placement.feed, placement.feed_scale, placement.path_mode = self._unlocked
            self._actions.append(SpindleLock(at=self._at, line=self.line, pitch=0.0))
        self._unlocked = None

    def rigid_tap(self, start: Position, target: Position, faster: float) -> None:
        """Take the way in, the spindle's turn about, the way out."""
        direction, speed = self._direction, self._speed
        self._add(MoveKind.FEED, target, _NO_CENTRE, 0)
        self._speed = speed if speed is None else speed * abs(faster)
        self._turn_spindle(-direction)
        self._add(MoveKind.FEED, start, _NO_CENTRE, 0)
        self._speed = speed
        self._turn_spindle(direction)

    def straight_probe(self, target: Position, *, toward: bool, must: bool) -> None:
        """Take a probing move as if nothing were in its way; it stops at its end."""
        self._actions.append(Probe(at=self._at, line=self.line, toward=toward, must=must))
        self._flush()
        mode = self._placement.path_mode
        self._placement.path_mode = PathMode.EXACT_STOP
        self._add(MoveKind.FEED, target, _NO_CENTRE, 0)
        self._flush()
        self._placement.path_mode = mode

    def unfinished(self, code: str, why: str) -> None:
        """Note a code that is taken as far as its moves go."""
        self._actions.append(Unfinished(at=self._at, line=self.line, code=code, why=why))
