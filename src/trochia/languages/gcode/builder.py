"""The sink that builds: canonical functions to a :class:`trochia.program.Program`.

In: canonical calls, program units and coordinates.  Out: columns of moves in machine coordinates, mm, degree and s,
and the actions between them.  No Python object per move: rows gather as plain numbers, and each batch is converted as
an array, by :mod:`trochia.kernels.placement`.
"""

from __future__ import annotations

from math import cos, radians, sin
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import ModalConflictError, Source
from trochia.kernels.placement import new_placement, place
from trochia.languages.gcode.frames import scaled
from trochia.languages.gcode.special_moves import SpecialMoves, require_finite
from trochia.languages.gcode.state import INCH
from trochia.languages.gcode.told_actions import ToldActions
from trochia.program import Action, MoveKind, PathMode, Plane, Program, TimeLaw
from trochia.program.moves import MOVE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.gcode import Rows
    from trochia.languages.gcode.sink import Position

    Moves = NDArray[Any]

_BATCH = 8192  # rows that gather before they are converted
_NO_CENTRE = (0.0, 0.0)
_MOST_POWER = 3.4e38  # what a column of single precision can hold
_KIND, _LINE, _TURNS, _RATE, _POWER, _CENTRE, _TARGET = 0, 1, 2, 3, 4, slice(5, 7), slice(7, 16)


class Builder(ToldActions, SpecialMoves):
    """Gathers moves and actions; :meth:`program` returns them.

    Parameters
    ----------
    name
        What the program is called.
    start
        Machine position before the first move (9) [mm, degree].
    room
        How many moves to expect; more are taken too.
    """

    def __init__(self, name: str, start: tuple[float, ...], room: int = _BATCH) -> None:
        self.line = 0
        self._name = name
        self._start = np.array(start, dtype=np.float64)
        self._rows: list[tuple[float, ...]] = []
        self._moves: Moves = np.empty(room, dtype=MOVE)  # memory that is not written to is not taken
        self._count = 0
        self._actions: list[Action] = []
        self._placement = new_placement()
        self._placement.position = list(start)
        self._origin = [0.0] * len(start)
        self._tool = [0.0] * len(start)
        self._direction = 0
        self._speed: float | None = None
        self._surface = self._mist = self._flood = False
        self._unlocked = None
        self._splines = [np.empty((0, 4, 3))]
        self._kept_path = (PathMode.BLEND_DEFAULT, [0.0, 0.0])

    def program(self, lines: int) -> Program:
        """Return the program; ``lines`` is the number of lines of its text."""
        self._flush()
        return Program(
            name=self._name,
            lines=lines,
            start=self._start.copy(),
            moves=self._moves[: self._count],
            actions=tuple(self._actions),
            splines=np.concatenate(self._splines),
        )

    # --- moves

    def straight_traverse(self, target: Position) -> None:
        """Take a rapid move."""
        self._add(MoveKind.RAPID, target, _NO_CENTRE, 0)

    def straight_feed(self, target: Position) -> None:
        """Take a feed move."""
        self._add(MoveKind.FEED, target, _NO_CENTRE, 0)

    def arc_feed(self, target: Position, centre: tuple[float, float], turns: int, plane: Plane) -> None:
        """Take an arc."""
        del plane  # it is the selected one
        self._add(MoveKind.ARC, target, centre, turns)

    def _add(self, kind: MoveKind, target: Position, centre: tuple[float, float], turns: int) -> None:
        self._rows.append((kind, self.line, turns, self._placement.feed, self._power, *centre, *target))
        if len(self._rows) >= _BATCH:
            self._flush()

    def moves(self, rows: Rows) -> None:
        """Take a batch of the fast path."""
        self._flush()
        placement = self._placement
        placement.lit, placement.new_speed, placement.speed = int(self._direction != 0), 0, self._speed_or_one
        self._take(rows.array(), fills=1)
        if placement.new_speed:
            self._speed = placement.speed

    def _flush(self) -> None:
        """Convert the rows gathered so far."""
        if not self._rows:
            return
        table = np.array(self._rows)
        self._rows.clear()
        moves = np.zeros(len(table), dtype=MOVE)
        for name, column in (("kind", _KIND), ("line", _LINE), ("turns", _TURNS), ("rate", _RATE), ("power", _POWER),
                             ("centre", _CENTRE), ("target", _TARGET)):  # fmt: skip
            moves[name] = table[:, column]
        self._take(moves)

    def _take(self, rows: Moves, fills: int = 0) -> None:
        """Convert rows with program coordinates, F and S words, and keep them; ``fills`` gives them their power."""
        placement = self._placement
        placement.fills = fills
        if placement.plane != Plane.XY and placement.sine and (rows["kind"] == MoveKind.ARC).any():
            raise ModalConflictError(
                "in a turned coordinate system an arc must lie in the XY plane",
                source=Source(self._name, int(rows["line"][(rows["kind"] == MoveKind.ARC).argmax()])),
                hint="Select G17, or a coordinate system that is not turned.",
            )
        if self._count + len(rows) > len(self._moves):
            grown = np.empty(2 * (self._count + len(rows)), dtype=MOVE)
            grown[: self._count] = self._moves[: self._count]
            self._moves = grown
        made = self._moves[self._count :]
        made = made[: place(rows, placement, made)]
        if not fills:  # numbers of the fast path are written out, and so not that great
            require_finite(made, self._name)
        self._count += len(made)

    @property
    def _power(self) -> float:
        """Power of the beam or speed of the spindle that is on, else 0."""
        return self._speed_or_one if self._direction else 0.0

    @property
    def _speed_or_one(self) -> float:
        """Speed or power that S asks for; 1 where no S was given."""
        return 1.0 if self._speed is None else min(self._speed, _MOST_POWER)

    @property
    def _at(self) -> int:
        return self._count + len(self._rows)

    # --- what the moves depend on

    def use_length_units(self, *, inch: bool) -> None:
        """Use inches or millimetres."""
        self._flush()
        scale = INCH if inch else 1.0
        placement = self._placement
        self._origin = scaled(self._origin, placement.scale / scale)
        self._tool = scaled(self._tool, placement.scale / scale)
        self._set_base()
        placement.shift = scaled(placement.shift, placement.scale / scale)
        placement.scale = scale

    def select_plane(self, plane: Plane) -> None:
        """Use another plane."""
        self._flush()
        self._placement.plane = plane

    def set_g5x_offset(self, system: int, offset: Position) -> None:
        """Use another origin."""
        del system
        self._flush()
        self._origin = list(offset)
        self._set_base()

    def _set_base(self) -> None:
        """Let the origin and the tool's offset, which a rotation does not turn, act together."""
        self._placement.origin = [origin + tool for origin, tool in zip(self._origin, self._tool, strict=True)]

    def set_g92_offset(self, offset: Position) -> None:
        """Use another shift."""
        self._flush()
        self._placement.shift = list(offset)

    def set_xy_rotation(self, degrees: float) -> None:
        """Use another rotation."""
        self._flush()
        self._placement.cosine, self._placement.sine = cos(radians(degrees)), sin(radians(degrees))

    def use_tool_length_offset(self, offset: Position) -> None:
        """Use another tool offset."""
        self._flush()
        self._tool = list(offset)
        self._set_base()

    def set_feed_mode(self, law: TimeLaw) -> None:
        """Let F mean something else."""
        self._flush()
        self._placement.law = law

    def set_feed_rate(self, rate: float) -> None:
        """Use another feed."""
        placement = self._placement
        if placement.feed_scale != placement.scale:
            self._flush()
            placement.feed_scale = placement.scale
        placement.feed = rate

    def set_inverse_time(self, per_minute: float, rate: float) -> None:
        """Let the next move last 1/F minutes."""
        del rate
        self._placement.feed = per_minute

    def set_motion_control_mode(self, mode: PathMode, tolerance: float) -> None:
        """Use another path mode."""
        self._flush()
        self._placement.path_mode = mode
        self._placement.tolerance = [tolerance * self._placement.scale, 0.0]

    def set_naivecam_tolerance(self, tolerance: float) -> None:
        """Use another tolerance along the path."""
        self._flush()
        self._placement.tolerance[1] = tolerance * self._placement.scale

    def set_feed_reference(self) -> None:
        """Nothing: feeds always refer to the part."""
