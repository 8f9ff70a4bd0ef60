"""The profile of a lathe cycle: what the lines of its subroutine draw, in X and Z.

In: sorted lines of the subroutine.  Out: :class:`Profile`, segments from point to point.  Only G0 to G3 draw; words
beside them, and codes of other kinds, are left unheard, as in the reference.  A at the end of a motion rounds the
corner there by a radius, C cuts it off where the arc would touch; U and W are steps of X and Z.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot, sqrt
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError, ProgramError
from trochia.geometry.rounding import rounded
from trochia.geometry.segments import NEAR, Segment
from trochia.languages.gcode.groups.arcs import SHORT_RADIUS, check_radii

if TYPE_CHECKING:
    from trochia.geometry.segments import Vector
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.state import State

_X, _Z, _A, _C, _U, _W = 0, 2, 3, 5, 6, 8  # columns
_DRAWS = {"G0": 0, "G1": 0, "G2": -1, "G3": 1}  # code -> sense


@dataclass(slots=True)
class Profile:
    """A profile that is being drawn, and the line of the cycle that asked for it.

    Attributes
    ----------
    block
        The line of the cycle; ``line`` its number in the main program.
    sub
        Number of the subroutine.
    start
        Where the cycle starts (z, x).
    segments
        The first one leads from the start to the first point.
    depth
        Calls in progress while its subroutine runs; 0: it has not been called yet.
    fault
        Why it cannot be drawn on; told where its subroutine ends, as in the reference.
    """

    block: Block
    line: int
    sub: int
    start: Vector
    segments: list[Segment] = field(default_factory=list[Segment])
    depth: int = 0
    fault: ProgramError | None = None
    _corner: tuple[float, bool, Place] | None = None

    def take(self, block: Block, state: State) -> None:
        """Draw a line of the subroutine.

        Raises
        ------
        ModalConflictError
            For a code that would use the axis words in another way.
        ParseError
            For an arc that has neither centre nor radius.
        """
        _refuse_others(block)
        if block.motion is None or not (block.axes or block.motion.name in ("G2", "G3")):
            return
        sense = _DRAWS[block.motion.name]
        if sense and not block.values.keys() & {"r", "i", "k"}:
            raise block.fault(ParseError, "an arc needs its centre or its radius", block.mover,
                              hint="Write I and K, or R.")  # fmt: skip
        if self.fault is None:
            try:
                self._draw(block, state, sense)
            except ProgramError as fault:
                self.fault = fault

    def _draw(self, block: Block, state: State, sense: int) -> None:
        here = state.position[_Z], state.position[_X]
        end = _end_of(block, state)
        state.position[_Z], state.position[_X] = end
        centre = _centre_of(block, state, here, end, sense) if sense else None
        state.motion = 10
        segment = Segment(start=here, end=end, centre=centre, sense=sense)
        if not segment.is_point or not self.segments:
            self._add(segment)
        self._corner = None
        for column, straight in ((_A, False), (_C, True)):
            if column in block.axes:
                self._corner = block.axes[column], straight, block.place

    def _add(self, segment: Segment) -> None:
        if self._corner is None or len(self.segments) < 2:
            self.segments.append(segment)
            return
        radius, straight, place = self._corner
        try:
            before, between, after = rounded(self.segments[-1], segment, radius, straight=straight)
        except ValueError:
            raise place.fault(
                ParseError, f"no {'chamfer' if straight else 'fillet'} of {radius:g} fits into the corner at this "
                "line's end", hint=f"Write a smaller {'C' if straight else 'A'}.",
            ) from None  # fmt: skip
        self.segments[-1] = before
        self.segments += [segment for segment in (between, after) if not segment.is_point]


def _refuse_others(block: Block) -> None:
    """Refuse codes that use axis words in another way."""
    motion, other = block.groups.get("motion"), block.groups.get("non-modal")
    wrong = None
    if motion is not None and motion.name not in _DRAWS and block.axes:
        wrong = motion
    elif other is not None and block.axes and (other.takes_axes or other.name == "G53"):
        wrong = other
    if wrong is not None:
        raise block.fault(ModalConflictError, f"{wrong.name} cannot stand in the profile of a lathe cycle", wrong.name,
                          hint="A profile is drawn by G0 to G3.")  # fmt: skip


def _end_of(block: Block, state: State) -> Vector:
    """Return where a line leads (z, x)."""
    ends: list[float] = []
    for column, step in ((_Z, _W), (_X, _U)):
        value = state.position[column]
        if column in block.axes:
            value = block.axes[column] + (0.0 if state.absolute else value)
        if step in block.axes:
            value += block.axes[step] * (0.5 if state.diameter and column == _X else 1.0)
        ends.append(value)
    return ends[0], ends[1]


def _centre_of(block: Block, state: State, start: Vector, end: Vector, sense: int) -> Vector:
    """Return the centre of an arc (z, x)."""
    values = block.values
    if "r" in values:
        return _by_radius(block, state, start, end, sense)
    if state.arc_absolute:
        centre = values.get("k", start[0]), values.get("i", start[1])
    else:
        centre = start[0] + values.get("k", 0.0), start[1] + values.get("i", 0.0)
    if hypot(end[0] - start[0], end[1] - start[1]) > NEAR:
        check_radii(block, state, start, end, centre)
    return centre


def _by_radius(block: Block, state: State, start: Vector, end: Vector, sense: int) -> Vector:
    """Return the centre of an arc by R, on the perpendicular bisector of its chord."""
    radius = block.values["r"]
    across, up = end[0] - start[0], end[1] - start[1]
    chord = hypot(across, up)
    if chord <= NEAR:
        return start
    if chord / 2 - abs(radius) > SHORT_RADIUS[state.inch]:
        raise block.fault(ParseError, f"radius {abs(radius):g} does not reach over a chord of {chord:.4f}", "r",
                          hint=f"R must be at least {chord / 2:.4f}.")  # fmt: skip
    left = sqrt(max(radius * radius - chord * chord / 4, 0.0)) / chord * (sense if radius > 0 else -sense)
    return (start[0] + end[0]) / 2 - up * left, (start[1] + end[1]) / 2 + across * left
