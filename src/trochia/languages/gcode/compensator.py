"""Cutter radius compensation: a stage between the interpreter and its sink while G41 or G42 is in force.

In: canonical calls, moves as programmed.  Out: the same calls to the sink behind, moves of the tool's centre.

Where a move ends is known only when the next one is, so a move waits, and what comes behind it waits too: a list of
calls that keep their order.  Units, plane, chosen tool and messages pass at once, as in the reference.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, tau
from typing import TYPE_CHECKING, Any

from trochia.languages.gcode import corners
from trochia.languages.gcode.corners import Circle, Vector
from trochia.languages.gcode.frames import scaled
from trochia.program.modes import MoveKind, Plane

if TYPE_CHECKING:
    from trochia.languages.gcode.sink import Position, Sink

_Later = tuple[int, Callable[..., None], tuple[Any, ...], dict[str, Any]]

_DIRECT = frozenset({"use_length_units", "select_plane", "select_tool", "message"})
_SETTLING = frozenset({"program_stop", "pallet_shuttle", "set_g5x_offset", "finish"})

_WITH_MOVE = frozenset({"set_inverse_time"})  # dropped where the move that follows is an error

#: How far the tip of a lathe tool lies from its centre, in radii (Z, X), by the tool's orientation 1 to 9.
TIPS = {1: (1, -1), 2: (-1, -1), 3: (-1, 1), 4: (1, 1), 5: (1, 0), 6: (0, -1), 7: (-1, 0), 8: (0, 1)}

ROUNDING = 1e-4  #: angle by which an arc may seem longer than programmed [rad]
SLACK = 0.01  #: share by which it may be longer, as the reference has it

_NO_TIP = (0, 0)
_NOT_REACHED = "the tool does not reach into this corner without cutting into the part"
_SMALLER_TOOL = "Use a smaller tool, or open the corner."


class GougeError(Exception):
    """A move the tool cannot make: a message and what to do; the interpreter makes it an error with a place."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.message, self.hint = message, hint


@dataclass(slots=True)
class _Move:
    """A move that waits for its end.  ``step`` is the programmed way in the plane, (0, 0) where only others move."""

    line: int
    kind: MoveKind
    target: list[float]
    step: Vector = (0.0, 0.0)
    circle: Circle | None = None
    turns: int = 0
    sweep: float = 0.0  # programmed angle of an arc [rad]; 0: not to be checked


class Compensator:
    """Moves the tool's centre beside the programmed path.

    Parameters
    ----------
    sink
        Receives the moves of the centre, and every other call.
    position
        Current point, program coordinates (9).
    plane
        XY or ZX.
    side
        +1 tool on the left, -1 on the right.
    radius
        Of the tool [program units]; 0 lets everything pass.
    orientation
        Of a lathe tool, 1 to 9; 0 for none.
    """

    def __init__(
        self, sink: Sink, position: Position, *, plane: Plane, side: int, radius: float, orientation: int = 0
    ) -> None:
        self.line = sink.line
        self.radius = radius
        self.plane = plane
        self._sink = sink
        self._axes = plane.axes
        self._side = side
        self._tip = TIPS.get(orientation, _NO_TIP) if plane == Plane.ZX else _NO_TIP
        self._at = list(position)  # with the centre's coordinates in the plane
        self._corner: Vector = (position[self._axes[0]], position[self._axes[1]])
        self._begun = False
        self._reached: Vector | None = None  # where the centre stands when what waits begins; None: not known
        self._waiting: list[_Move | _Later] = []

    # --- moves

    @property
    def side(self) -> int:
        """+1 tool on the left, -1 on the right."""
        return self._side

    def straight_traverse(self, target: Position) -> None:
        """Take a rapid move."""
        self._straight(MoveKind.RAPID, target)

    def straight_feed(self, target: Position) -> None:
        """Take a feed move."""
        self._straight(MoveKind.FEED, target)

    def _straight(self, kind: MoveKind, target: Position) -> None:
        first, second = self._axes
        end = target[first], target[second]
        step = end[0] - self._corner[0], end[1] - self._corner[1]
        if not self.radius:
            self._wait(_Move(self.line, kind, list(target)), end, end)
            self.flush()
        elif not self._begun:
            self._enter_straight(kind, target, end, step)
        elif step == (0.0, 0.0):
            self._wait(_Move(self.line, kind, list(target)), end, self._centre)
        else:
            normal = corners.normal_of(*step, self._side)
            self._turn(normal, kind, None)
            self._wait(_Move(self.line, kind, list(target), step), end, self._beside(end, normal))

    def arc_feed(self, target: Position, centre: Vector, turns: int, plane: Plane) -> None:
        """Take an arc.

        Raises
        ------
        GougeError
            Where the tool does not fit into it.
        """
        del plane
        first, second = self._axes
        end, start = (target[first], target[second]), self._corner
        sense = 1 if turns > 0 else -1
        inside = self._side * sense > 0
        move = _Move(self.line, MoveKind.ARC, list(target), turns=turns)
        if not self.radius:
            move.circle = Circle(centre, _distance(end, centre), sense, inside)
            self._wait(move, end, end)
            self.flush()
            return
        size = _distance(end, centre)
        if inside and size <= self.radius:
            raise GougeError(f"the tool of radius {self.radius:g} does not fit into an arc of radius {size:g}",
                             "Use a smaller tool, or a greater arc.")  # fmt: skip
        normal = self._radial(end, centre, inside=inside)
        if not self._begun:
            move.circle = self._enter_arc(end, normal, sense, inside=inside)
        else:
            grown = -self.radius if inside else self.radius
            new = Circle(centre, _distance(start, centre) + grown, sense, inside)
            self._turn(self._radial(start, centre, inside=inside), MoveKind.ARC, new)
            move.circle = Circle(centre, size + grown, sense, inside)
            move.sweep = (corners.swept(start, end, centre, sense) or tau) + (abs(turns) - 1) * tau
        self._wait(move, end, self._beside(end, normal))

    def _enter_straight(self, kind: MoveKind, target: Position, end: Vector, step: Vector) -> None:
        """Take the first move: it ends beside its end."""
        length = hypot(*step)
        if length <= self.radius:
            raise GougeError(f"the entry move is {length:g} long, which is not more than the tool's radius, "
                             f"{self.radius:g}", "Begin compensation farther away.")  # fmt: skip
        self.flush()
        self._begun = True
        move = _Move(self.line, kind, list(target), step)
        self._wait(move, end, self._beside(end, corners.normal_of(*step, self._side)))

    def _enter_arc(self, end: Vector, normal: Vector, sense: int, *, inside: bool) -> Circle:
        """Return the arc from the current point that ends beside the end of the programmed one, along with it."""
        if self._tip != _NO_TIP:
            raise GougeError("with a lathe tool's orientation, compensation must begin by a line",
                             "Lead in by G0 or G1.")  # fmt: skip
        chord = _distance(self._corner, end)
        centre = corners.entry_centre(self._corner, self._beside(end, normal), normal)
        if centre is None or chord <= self.radius:
            raise GougeError(f"the entry arc spans {chord:g}, which is not more than the tool's radius, "
                             f"{self.radius:g}", "Begin compensation farther away, or by a line.")  # fmt: skip
        self.flush()
        self._begun = True
        return Circle(centre, _distance(self._corner, centre), sense, inside)

    def _turn(self, after: Vector, kind: MoveKind, circle: Circle | None) -> None:
        """End what waits at the corner in which a new path begins, and go around the corner if it opens."""
        centre, corner = self._centre, self._corner
        before = (centre[0] - corner[0]) / self.radius, (centre[1] - corner[1]) / self.radius
        angle = corners.bend(before, after, self._side)
        if corners.closes(angle) or (self._leads_along(circle) and corners.turns_back(angle)):
            self._end_at(self._meeting(before, after, circle))
        elif corners.opens(angle):
            if circle is None:
                self._end_at(centre)
            else:  # the reference does not look back here
                self.flush()
            self._go_around(self._beside(corner, after), kind)
        else:
            self.flush()
            self._reached = centre

    def _leads_along(self, new: Circle | None) -> bool:
        """Return whether the new path, or else the old, is an arc that the tool rounds.

        Where such paths turn back, the tool can stay on the arc's side instead of going around its end.
        """
        arc = new if new is not None else self._front_circle()
        return arc is not None and not arc.inside

    def _meeting(self, before: Vector, after: Vector, new: Circle | None) -> Vector:
        """Return where the centre leaves the old path for the new one, in a corner towards the tool."""
        old = self._front_circle()
        corner, side = self._corner, self._side
        along = (before[1] * side, -before[0] * side), (after[1] * side, -after[0] * side)
        if old is None and new is None:
            point = corners.line_to_line(corner, before, after, self.radius)
        elif old is None and new is not None:
            point = corners.line_to_circle(self._centre, along[0], new, ahead=new.inside)
        elif old is not None and new is None:
            seen = corners.on_programmed_arc(corner, old, self.radius)
            point = corners.line_to_circle(self._beside(seen, after), along[1], old, ahead=not old.inside)
        else:
            assert old is not None
            assert new is not None
            point = corners.circle_to_circle(old, new)
        if point is None:
            raise GougeError(_NOT_REACHED, _SMALLER_TOOL)
        return point

    def _go_around(self, end: Vector, kind: MoveKind) -> None:
        """Move the centre around an open corner: an arc about it, or straight in a rapid move."""
        first, second = self._axes
        target = self._at.copy()
        target[first], target[second] = end
        if kind == MoveKind.RAPID:
            move = _Move(self.line, kind, target)
        else:
            circle = Circle(self._corner, self.radius, -self._side, inside=False)
            move = _Move(self.line, MoveKind.ARC, target, circle=circle, turns=-self._side)
        self._send(move)
        self._reached = end

    # --- what waits

    def _front_circle(self) -> Circle | None:
        front = self._waiting[0] if self._waiting else None
        return front.circle if isinstance(front, _Move) else None

    def _wait(self, move: _Move, corner: Vector, centre: Vector) -> None:
        """Let a move wait; then the programmed path stands at ``corner``, the tool's centre at ``centre``."""
        first, second = self._axes
        move.target[first], move.target[second] = centre
        self._waiting.append(move)
        self._at = move.target.copy()
        self._corner = corner

    def _end_at(self, point: Vector) -> None:
        """Let all waiting moves end at another point, and send them.

        Raises
        ------
        GougeError
            Where a move would go backwards.
        """
        if not self._waiting:
            return
        first, second = self._axes
        for entry in self._waiting:
            if isinstance(entry, _Move):
                if self._reached is not None:
                    _check_forward(entry, self._reached, point)
                entry.target[first], entry.target[second] = point
        self.flush()
        self._reached = point

    def settle(self) -> None:
        """Let what waits end where it ends, and send it.

        Raises
        ------
        GougeError
            Where a move would go backwards, because the corner before it left no room.
        """
        self._end_at(self._centre)
        self._reached = None

    def forget(self) -> None:
        """Drop all that waits, after an error."""
        self._waiting.clear()
        self._reached = None

    def flush(self) -> None:
        """Send all that waits, as it is."""
        for entry in self._waiting:
            if isinstance(entry, _Move):
                self._send(entry)
            else:
                line, call, values, named = entry
                self._sink.line = line
                call(*values, **named)
        self._waiting.clear()
        self._reached = None

    def _send(self, move: _Move) -> None:
        """Send a move; the sink gets the point the machine follows, which is the tip of a lathe tool."""
        target, sink = move.target, self._sink
        sink.line = move.line
        shift = self._tip[0] * self.radius, self._tip[1] * self.radius
        if self._tip is not _NO_TIP:
            target = target.copy()
            target[self._axes[0]] += shift[0]
            target[self._axes[1]] += shift[1]
        if move.circle is not None:
            centre = move.circle.centre
            sink.arc_feed(target, (centre[0] + shift[0], centre[1] + shift[1]), move.turns, self.plane)
        elif move.kind == MoveKind.RAPID:
            sink.straight_traverse(target)
        else:
            sink.straight_feed(target)

    # --- other calls

    def __getattr__(self, name: str) -> Callable[..., None]:
        """Return a canonical call that waits its turn, or passes at once where nothing waits or it must."""
        call = getattr(self._sink, name)
        if name in _SETTLING:
            self.settle()
        if name in _DIRECT or not (self._waiting or name in _WITH_MOVE):
            self._sink.line = self.line
            return call
        return lambda *values, **named: self._waiting.append((self.line, call, values, named))

    def rescale(self, factor: float) -> None:
        """Convert what is known in program units by a factor."""
        self.radius *= factor
        self._at = scaled(self._at, factor)
        self._corner = self._corner[0] * factor, self._corner[1] * factor
        if self._reached is not None:
            self._reached = self._reached[0] * factor, self._reached[1] * factor
        for entry in self._waiting:
            if isinstance(entry, _Move):
                entry.target = scaled(entry.target, factor)
                entry.step = entry.step[0] * factor, entry.step[1] * factor
                if entry.circle is not None:
                    circle = entry.circle
                    entry.circle = Circle((circle.centre[0] * factor, circle.centre[1] * factor),
                                          circle.radius * factor, circle.sense, circle.inside)  # fmt: skip

    # --- places

    @property
    def _centre(self) -> Vector:
        return self._at[self._axes[0]], self._at[self._axes[1]]

    def _beside(self, point: Vector, normal: Vector) -> Vector:
        return point[0] + self.radius * normal[0], point[1] + self.radius * normal[1]

    @staticmethod
    def _radial(point: Vector, centre: Vector, *, inside: bool) -> Vector:
        """Return the unit vector from a point of an arc to the tool: to the centre if it runs inside."""
        across, up = centre[0] - point[0], centre[1] - point[1]
        length = hypot(across, up) * (1 if inside else -1)
        return across / length, up / length


def _distance(one: Vector, other: Vector) -> float:
    return hypot(one[0] - other[0], one[1] - other[1])


def _check_forward(move: _Move, start: Vector, end: Vector) -> None:
    """Check that a move with new ends still goes the way it was programmed."""
    if move.circle is None:
        backwards = move.step[0] * (end[0] - start[0]) + move.step[1] * (end[1] - start[1]) < 0
    elif move.sweep:
        more = corners.swept(start, end, move.circle.centre, move.circle.sense) - move.sweep
        backwards = ROUNDING < more < tau - ROUNDING and more > SLACK * move.sweep
    else:
        backwards = False
    if backwards:
        raise GougeError(_NOT_REACHED, _SMALLER_TOOL)
