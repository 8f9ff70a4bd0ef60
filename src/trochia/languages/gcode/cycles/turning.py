"""G70, G71, G72 and their .1 and .2: lathe cycles along a profile.

In: the number of the subroutine that draws the profile (Q), the start (X Z), and distances.  Out: once the subroutine
has been run, the moves of the cycle.

G71 cuts along Z, G72 along X: passes I deep, R off the cut on the way back, D left on the profile.  G7x.1 leaves what
lies behind the first pocket, G7x.2 clears only that.  G70 finishes along the profile: P passes, from D to E off it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.geometry.parallel import parallel
from trochia.geometry.segments import NEAR, Segment, cross
from trochia.languages.gcode.codes import Code, Handler, table
from trochia.languages.gcode.cycles.profile import Profile
from trochia.languages.gcode.cycles.roughing import MOST_LEVELS, Move, Roughing
from trochia.languages.gcode.groups.motion import require_feed, target_of
from trochia.languages.gcode.numbers import as_integer
from trochia.program.modes import AXES, Plane

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from trochia.geometry.segments import Vector
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_X, _Z = 0, 2
_MOST_PASSES = 10_000  # of G70
_NEAR_END = 1e-3  # of an arc: where it turns back so near to an end, it does not, as in the reference [program units]
_LEAST_ARC = 0.01  # along the passes, of arcs round corners [program units], in the reference


@dataclass(frozen=True, slots=True)
class Frame:
    """The frame of a cycle: its first axis along the passes, its second away from the part.

    ``facing`` passes lead along X; ``along`` and ``away`` are the signs of the axes.  Points of the program are (z, x).
    """

    facing: bool
    along: int
    away: int

    def point(self, point: Vector) -> Vector:
        """Return a point of the program in the frame."""
        first, second = (point[1], point[0]) if self.facing else point
        return self.along * first, self.away * second

    def back(self, point: Vector) -> Vector:
        """Return a point of the frame in the program."""
        first, second = self.along * point[0], self.away * point[1]
        return (second, first) if self.facing else (first, second)

    @property
    def hand(self) -> int:
        """Return -1 where the frame mirrors, so that arcs turn the other way."""
        return self.along * self.away * (-1 if self.facing else 1)

    def segment(self, segment: Segment) -> Segment:
        """Return a segment of the program in the frame."""
        centre = None if segment.centre is None else self.point(segment.centre)
        return Segment(start=self.point(segment.start), end=self.point(segment.end), centre=centre,
                       sense=self.hand * segment.sense)  # fmt: skip


def _cycle(block: Block, state: State, sink: Sink) -> None:
    """G70 to G72.2: go to the start, and ask for the profile; :func:`finish` does the rest."""
    _check_state(block, state)
    sink.straight_traverse(end := target_of(block, state))
    number = as_integer(block.values["q"])
    if number is None:
        raise block.fault(ParseError, "Q is the whole number of a subroutine", "q", hint="Write it like Q100.")
    state.position = end
    state.motion = 0
    state.profile = Profile(block, sink.line, number, (end[_Z], end[_X]))


def _check_state(block: Block, state: State) -> None:
    """Refuse a cycle that cannot begin, after what stands before it on its line has acted, as in the reference."""
    assert block.motion is not None
    name = block.motion.name
    if "q" not in block.values:
        raise block.fault(ParseError, f"{name} needs Q", name, hint="Q is the number of the subroutine that draws "
                          "the profile: O100 SUB … O100 ENDSUB, G71 Q100.")  # fmt: skip
    if state.compensation is not None:
        raise block.fault(ModalConflictError, f"{name} cannot be used with cutter compensation", name,
                          hint="Write G40 before it.")  # fmt: skip
    if state.plane != Plane.ZX:
        raise block.fault(ModalConflictError, f"{name} lies in the ZX plane", name, hint="Write G18 before it.")
    for column in block.axes:
        if column not in (_X, _Z):
            letter = AXES[column]
            raise block.fault(ParseError, f"{name} cannot move {letter}", letter.lower(),
                              hint="Move it on a line of its own.")  # fmt: skip


def finish(profile: Profile, there: Block, state: State, sink: Sink) -> None:
    """Send the moves of a cycle whose profile has been drawn; ``there`` is the line that ended its subroutine.

    Raises
    ------
    ProgramError
        For a profile that the cycle cannot follow; moves before that have been sent.
    """
    assert profile.block.motion is not None
    name = f"{profile.block.motion.name} of line {profile.block.place.line}"
    if (fault := profile.fault) is not None:
        assert fault.source is not None
        column = f", column {fault.source.column}" if fault.source.column else ""
        where = f"line {fault.source.line}{column} of its profile"
        raise there.fault(type(fault), f"{name}: {where}: {fault.message}", hint=fault.hint)
    try:
        moves = _moves(profile)
    except ValueError as error:
        hint = _HINTS.get(str(error), "Write a smaller D (or E), or a wider corner.")
        raise there.fault(ModalConflictError, f"{name}: {error}", hint=hint) from None
    for move in moves:
        _send(move, there, state, sink)


_MONOTONIC = "the profile turns back along the direction of the passes"
_TOO_MANY = f"more than {MOST_LEVELS} passes"
_NO_DEPTH = "its I must be above 0"
_HINTS = {
    _NO_DEPTH: "I is the depth of a pass.",
    _MONOTONIC: "G71 needs a Z that always rises or falls along the profile, G72 such an X, G70 one of them.",
    _TOO_MANY: "Write a greater I.",
}


def _moves(profile: Profile) -> list[Move]:
    """Return the moves of a cycle in the program's coordinates (z, x)."""
    assert profile.block.motion is not None
    name, values = profile.block.motion.name, profile.block.values
    contour = profile.segments[1:]
    if name != "G70" and values.get("i", 1.0) <= 0:
        raise ValueError(_NO_DEPTH)
    if not contour:
        return []
    frame = _frame_of(contour, name)
    drawn = [frame.segment(segment) for segment in contour]
    first = drawn[0].start
    start = frame.point(profile.start)
    start = min(start[0], first[0]), start[1]
    left = values.get("d", 0.0) * _side(drawn, start)
    found = [Move(start, rapid=True)]
    if name == "G70":
        found += _finishing(drawn, start, values)
    else:
        path = _path(start, parallel(drawn, left, least=_LEAST_ARC))
        cut = Roughing(increment=values.get("i", 1.0), retract=values.get("r", 0.5), pockets=int(name[4:] or "0"))
        found += cut.moves(path)
    return [_in_program(move, frame) for move in found]


def _in_program(move: Move, frame: Frame) -> Move:
    centre = None if move.centre is None else frame.back(move.centre)
    return Move(frame.back(move.end), move.rapid, centre, frame.hand * move.sense)


def _frame_of(contour: Sequence[Segment], name: str) -> Frame:
    """Return the frame in which the profile leads ahead and rises.

    Raises
    ------
    ValueError
        Where it turns back.
    """
    first, last = contour[0].start, contour[-1].end
    for facing in {"G70": (False, True)}.get(name, (name.startswith("G72"),)):
        along, away = (1, 0) if facing else (0, 1)
        frame = Frame(
            facing,
            1 if last[along] > first[along] else -1,
            1 if last[away] > first[away] - (0.0 if facing else NEAR) else -1,
        )
        if all(_leads_ahead(frame.segment(segment)) for segment in contour):
            return frame
    raise ValueError(_MONOTONIC)


def _leads_ahead(segment: Segment) -> bool:
    if segment.end[0] < segment.start[0] - NEAR:
        return False
    if segment.centre is None:
        return True
    points = [(segment.centre[0] + side * segment.radius, segment.centre[1]) for side in (-1, 1)]
    return not any(segment.holds(point) and not _is_end(segment, point) for point in points)


def _is_end(segment: Segment, point: Vector) -> bool:
    return any(hypot(end[0] - point[0], end[1] - point[1]) <= _NEAR_END for end in (segment.start, segment.end))


def _side(drawn: Sequence[Segment], start: Vector) -> int:
    """Return +1 where distances count away from the part, -1 where the start lies on the profile's other side.

    The reference takes the side of the line from the profile's beginning to that of its last segment.
    """
    first, last = drawn[0].start, drawn[-1].start
    aside = cross((last[0] - first[0], last[1] - first[1]), (start[0] - first[0], start[1] - first[1]))
    return -1 if aside < -NEAR else 1


def _path(start: Vector, contour: Sequence[Segment]) -> list[Segment]:
    """Return the way from the start along a contour, and out to the height of the start where it ends below that.

    Raises
    ------
    ValueError
        Where nothing is left of the contour.
    """
    if not contour:
        raise ValueError("nothing is left of the profile at that distance")
    end = contour[-1].end
    path = [Segment(start=start, end=contour[0].start), *contour]
    return [*path, Segment(start=end, end=(end[0], start[1]))] if end[1] < start[1] else path


def _finishing(drawn: Sequence[Segment], start: Vector, values: dict[str, float]) -> list[Move]:
    """Return the passes of G70: the last one E off the profile, the first nearly D."""
    passes, side = values.get("p", 1.0), _side(drawn, start)
    if passes > _MOST_PASSES:
        raise ValueError(_TOO_MANY)
    last = values.get("e", 0.0)
    found: list[Move] = []
    for left in reversed(range(int(passes))):
        off = last + (values.get("d", 0.0) - last) * left / passes
        contour = parallel(drawn, side * off, least=_LEAST_ARC)
        found += [Move(start, rapid=True)] if found else []
        found += [Move(contour[0].start, rapid=True)]
        found += [Move(segment.end, centre=segment.centre, sense=segment.sense) for segment in contour]
    return found


def _send(move: Move, block: Block, state: State, sink: Sink) -> None:
    """Send one move."""
    end = state.position.copy()
    end[_Z], end[_X] = move.end
    if move.rapid:
        sink.straight_traverse(end)
        state.motion = 0
    else:
        require_feed(block, state)
        if move.centre is None:
            sink.straight_feed(end)
            state.motion = 10
        else:
            sink.arc_feed(end, move.centre, move.sense, Plane.ZX)
            state.motion = 20 if move.sense < 0 else 30
    state.position = end


def _check(block: Block, state: State) -> None:
    """Check the line of the cycle before anything on it acts."""
    del state
    assert block.motion is not None
    name = block.motion.name
    if "stopping" in block.groups:
        raise block.fault(ModalConflictError, f"{block.groups['stopping'].name} cannot stand beside {name}",
                          block.groups["stopping"].name, hint="Use two lines.")  # fmt: skip


def _rows(*cycles: tuple[str, str]) -> Iterable[Code]:
    run: Handler = _cycle
    for name, about in cycles:
        words = "qdep" if name == "G70" else "qdir"
        yield Code(name=name, about=about, group="motion", step="motion", run=run, words=words, check=_check)


G_CODES = table(
    *_rows(
        ("G70", "finish along a profile"),
        ("G71", "rough a profile along Z"),
        ("G71.1", "rough a profile along Z up to the end of its first pocket"),
        ("G71.2", "rough the pockets of a profile along Z behind the first"),
        ("G72", "rough a profile along X"),
        ("G72.1", "rough a profile along X up to the end of its first pocket"),
        ("G72.2", "rough the pockets of a profile along X behind the first"),
    )
)
