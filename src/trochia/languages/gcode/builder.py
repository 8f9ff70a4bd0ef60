"""The sink that builds: canonical functions to a :class:`trochia.program.Program`.

In: canonical calls, program units and coordinates.  Out: columns of moves in machine coordinates, mm, degree and s,
and the actions between them.  No Python object per move: rows gather as plain numbers, and each batch is converted as
an array.

machine = (turn(program + shift) + origin) * scale; ``turn`` turns X and Y about Z, ``scale`` is the length of a program
unit [mm] and leaves rotary axes alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import ModalConflictError, Source
from trochia.kernels.gcode import COMMENT_ROW, FEED_ROW
from trochia.languages.gcode.frames import LINEAR
from trochia.languages.gcode.state import INCH
from trochia.program import (
    Action,
    Coolant,
    Dwell,
    End,
    Message,
    MoveKind,
    PathMode,
    Pause,
    Plane,
    Program,
    Spindle,
    TimeLaw,
    ToolChange,
)
from trochia.program.moves import MOVE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.gcode import Rows
    from trochia.languages.gcode.sink import Position

    Moves = NDArray[Any]

_BATCH = 8192  # rows that gather before they are converted
_ROTARY = (3, 4, 5)
_NO_CENTRE = (0.0, 0.0)
_KIND, _LINE, _TURNS, _RATE, _POWER, _CENTRE, _TARGET = 0, 1, 2, 3, 4, slice(5, 7), slice(7, 16)


@dataclass(slots=True)
class _Frame:
    """How program coordinates become machine coordinates."""

    scale: float = 1.0
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(9))
    shift: NDArray[np.float64] = field(default_factory=lambda: np.zeros(9))
    rotation: float = 0.0

    def place(self, moves: Moves, plane: Plane) -> None:
        """Convert targets and centres in place."""
        target = moves["target"]
        target += self.shift
        self._turn(target)
        target += self.origin
        target[:, list(LINEAR)] *= self.scale
        axes = list(plane.axes)
        centre = moves["centre"]
        centre += self.shift[axes]
        if plane == Plane.XY:
            self._turn(centre)
        centre += self.origin[axes]
        centre *= self.scale
        centre[moves["kind"] != MoveKind.ARC] = 0.0

    def _turn(self, points: NDArray[np.float64]) -> None:
        """Turn the first two columns about Z."""
        if self.rotation:
            angle = np.radians(self.rotation)
            c, s = np.cos(angle), np.sin(angle)
            points[:, :2] = points[:, :2] @ np.array([[c, s], [-s, c]])


class Builder:
    """Gathers moves and actions; :meth:`program` returns them.

    Parameters
    ----------
    name
        What the program is called.
    start
        Machine position before the first move (9) [mm, degree].
    """

    def __init__(self, name: str, start: tuple[float, ...]) -> None:
        self.line = 0
        self._name = name
        self._start = np.array(start, dtype=np.float64)
        self._last = self._start
        self._rows: list[tuple[float, ...]] = []
        self._chunks: list[Moves] = []
        self._count = 0
        self._actions: list[Action] = []
        self._frame = _Frame()
        self._plane = Plane.XY
        self._law = TimeLaw.PER_SECOND
        self._feed = 0.0  # F as the program gave it, in units of the length below
        self._feed_scale = 1.0
        self._path = (PathMode.BLEND_DEFAULT, 0.0, 0.0)
        self._direction = 0
        self._speed: float | None = None
        self._mist = self._flood = False

    def program(self, lines: int) -> Program:
        """Return the program; ``lines`` is the number of lines of its text."""
        self._flush()
        moves = np.concatenate(self._chunks) if self._chunks else np.zeros(0, dtype=MOVE)
        return Program(
            name=self._name, lines=lines, start=self._start.copy(), moves=moves, actions=tuple(self._actions)
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
        self._rows.append((kind, self.line, turns, self._feed, self._power, *centre, *target))
        if len(self._rows) >= _BATCH:
            self._flush()

    def moves(self, rows: Rows) -> None:
        """Take a batch of the fast path."""
        self._flush()
        batch = rows.array()
        batch = batch[batch["kind"] != COMMENT_ROW]
        feeds = np.flatnonzero(batch["kind"] == FEED_ROW)
        if len(feeds) and self._feed_scale != self._frame.scale:  # the old feed still counts in the old unit
            first = feeds[0]
            self._take_batch(batch[:first], feeds[:0])
            batch, feeds = batch[first:], feeds - first
            self._feed_scale = self._frame.scale
        self._take_batch(batch, feeds)

    def _take_batch(self, batch: Moves, feeds: NDArray[np.intp]) -> None:
        """Take rows among which those at ``feeds`` are F words."""
        which = np.searchsorted(feeds, np.arange(len(batch)), side="right")
        rates = np.concatenate([[self._feed], batch["rate"][feeds]])
        is_move = batch["kind"] != FEED_ROW
        moves = batch[is_move].copy()
        moves["rate"] = rates[which][is_move]
        moves["power"] = self._power
        self._feed = float(rates[-1])
        self._take(moves)

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

    def _take(self, moves: Moves) -> None:
        """Convert rows with program coordinates and F words, and keep them."""
        if not len(moves):
            return
        arcs = moves["kind"] == MoveKind.ARC
        if self._plane != Plane.XY and self._frame.rotation and arcs.any():
            raise ModalConflictError(
                "in a turned coordinate system an arc must lie in the XY plane",
                source=Source(self._name, int(moves["line"][arcs.argmax()])),
                hint="Select G17, or a coordinate system that is not turned.",
            )
        self._frame.place(moves, self._plane)
        moves["plane"] = self._plane
        moves["law"] = self._law
        moves["path_mode"], moves["tolerance"] = self._path[0], self._path[1:]
        self._set_rates(moves)
        self._last = moves["target"][-1].copy()
        self._count += len(moves)
        self._chunks.append(moves)

    def _set_rates(self, moves: Moves) -> None:
        """Turn F words into rates: mm/s, mm per turn, or moves per second; degree/s where only rotary axes move."""
        seconds = 1.0 if self._law == TimeLaw.PER_REV else 60.0
        if self._law == TimeLaw.INVERSE:
            moves["rate"] /= seconds
        else:
            moved = np.diff(moves["target"], axis=0, prepend=self._last[None, :]) != 0
            rotary = moved[:, _ROTARY].any(axis=1) & ~moved[:, LINEAR].any(axis=1) & (moves["kind"] != MoveKind.ARC)
            moves["rate"] *= np.where(rotary, 1.0, self._feed_scale) / seconds
        moves["rate"][moves["kind"] == MoveKind.RAPID] = 0.0

    @property
    def _power(self) -> float:
        """Power of the beam or speed of the spindle that is on; 1 where no S was given."""
        if not self._direction:
            return 0.0
        return 1.0 if self._speed is None else self._speed

    @property
    def _at(self) -> int:
        return self._count + len(self._rows)

    # --- what the moves depend on

    def use_length_units(self, *, inch: bool) -> None:
        """Use inches or millimetres."""
        self._flush()
        scale = INCH if inch else 1.0
        self._frame.origin[list(LINEAR)] *= self._frame.scale / scale
        self._frame.shift[list(LINEAR)] *= self._frame.scale / scale
        self._frame.scale = scale

    def select_plane(self, plane: Plane) -> None:
        """Use another plane."""
        self._flush()
        self._plane = plane

    def set_g5x_offset(self, system: int, offset: Position) -> None:
        """Use another origin."""
        del system
        self._flush()
        self._frame.origin = np.array(offset)

    def set_g92_offset(self, offset: Position) -> None:
        """Use another shift."""
        self._flush()
        self._frame.shift = np.array(offset)

    def set_xy_rotation(self, degrees: float) -> None:
        """Use another rotation."""
        self._flush()
        self._frame.rotation = degrees

    def use_tool_length_offset(self, offset: Position) -> None:
        """Nothing: the language has no tool lengths yet, so the offset is zero."""

    def set_feed_mode(self, law: TimeLaw) -> None:
        """Let F mean something else."""
        self._flush()
        self._law = law

    def set_feed_rate(self, rate: float) -> None:
        """Use another feed."""
        if self._feed_scale != self._frame.scale:
            self._flush()
            self._feed_scale = self._frame.scale
        self._feed = rate

    def set_inverse_time(self, per_minute: float, rate: float) -> None:
        """Let the next move last 1/F minutes."""
        del rate
        self._feed = per_minute

    def set_motion_control_mode(self, mode: PathMode, tolerance: float) -> None:
        """Use another path mode."""
        self._flush()
        self._path = (mode, tolerance * self._frame.scale, 0.0)

    def set_naivecam_tolerance(self, tolerance: float) -> None:
        """Use another tolerance along the path."""
        self._flush()
        self._path = (*self._path[:2], tolerance * self._frame.scale)

    def set_feed_reference(self) -> None:
        """Nothing: feeds always refer to the part."""

    # --- actions

    def dwell(self, seconds: float) -> None:
        """Wait."""
        self._actions.append(Dwell(at=self._at, line=self.line, seconds=seconds))

    def set_spindle_mode(self) -> None:
        """Nothing: S is the speed, as it always is."""

    def set_spindle_speed(self, speed: float) -> None:
        """Use another speed or power."""
        self._turn_spindle(self._direction, speed)

    def start_spindle(self, direction: int) -> None:
        """Start the spindle or beam."""
        self._turn_spindle(direction, self._speed)

    def stop_spindle(self) -> None:
        """Stop the spindle or beam."""
        self._turn_spindle(0, self._speed)

    def _turn_spindle(self, direction: int, speed: float | None) -> None:
        """Keep what is new; an action stands only where what turns changes."""
        if direction != self._direction or (direction and speed != self._speed):
            self._actions.append(Spindle(at=self._at, line=self.line, direction=direction, speed=speed or 0.0))
        self._direction, self._speed = direction, speed

    def mist(self, *, on: bool) -> None:
        """Switch mist."""
        self._cool(mist=on, flood=self._flood)

    def flood(self, *, on: bool) -> None:
        """Switch flood."""
        self._cool(mist=self._mist, flood=on)

    def _cool(self, *, mist: bool, flood: bool) -> None:
        if (mist, flood) != (self._mist, self._flood):
            self._actions.append(Coolant(at=self._at, line=self.line, mist=mist, flood=flood))
        self._mist, self._flood = mist, flood

    def select_tool(self, tool: int) -> None:
        """Nothing: the change is what counts."""

    def start_change(self) -> None:
        """Nothing: the change follows."""

    def change_tool(self, tool: int) -> None:
        """Change the tool."""
        self._actions.append(ToolChange(at=self._at, line=self.line, tool=tool))

    def comment(self, text: str) -> None:
        """Nothing: a comment is no action."""

    def message(self, text: str) -> None:
        """Tell the operator."""
        self._actions.append(Message(at=self._at, line=self.line, text=text))

    def program_stop(self, *, optional: bool) -> None:
        """Wait for the operator."""
        self._actions.append(Pause(at=self._at, line=self.line, optional=optional))

    def pallet_shuttle(self) -> None:
        """Nothing: no machine here has pallets."""

    def program_end(self) -> None:
        """End the program."""
        self._actions.append(End(at=self._at, line=self.line))

    def finish(self) -> None:
        """Nothing: the text ended without an end code."""

    def on_reset(self) -> None:
        """Nothing: no state of the interpreter reaches the program."""
