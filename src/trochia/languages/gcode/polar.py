"""Polar words: ``@`` is the distance from the program origin, ``^`` the angle from X [degree], in XY.

In: a sorted line that has them.  Out: the point they lead to, in program coordinates.  A word that is missing keeps
its present value; in incremental mode the words add to the present distance and angle.
"""

from __future__ import annotations

from math import atan2, cos, hypot, radians, sin
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.program.modes import Plane

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.state import State

#: letter -> what it is
POLAR = {
    "@": "distance from the program origin in XY [program units]",
    "^": "angle about the program origin, from X toward Y [degree]",
}
Point = tuple[float, float]  #: X and Y, program coordinates


def check_polar(block: Block, state: State) -> None:
    """Check that the line's polar words can be read, before anything on it acts.

    Raises
    ------
    ParseError
        For X or Y beside them, and where they are no target of a motion.
    ModalConflictError
        In a plane other than XY.
    """
    word = _first(block)
    for column, letter in enumerate("xy"):
        if column in block.axes:
            raise block.fault(ParseError, f"{letter.upper()} cannot stand beside polar words", letter,
                              hint="Write the point by X and Y, or by @ and ^.")  # fmt: skip
    if block.motion is None or block.motion.name in ("G5.2", "G5.3"):
        raise block.fault(ParseError, "polar words are targets of motions only", word, hint="Write X and Y here.")
    if state.plane != Plane.XY:
        raise block.fault(ModalConflictError, "polar words lie in the XY plane", word, hint="Write G17 before it.")


def polar_target(block: Block, state: State) -> Point:
    """Return where the polar words lead from the current point.

    Raises
    ------
    ModalConflictError
        For machine coordinates (G53), and at the origin, which has no angle: for ``@`` without ``^``, and for any of
        them in incremental mode.
    """
    if block.in_machine:
        raise block.fault(ModalConflictError, "polar words cannot be machine coordinates (G53)", _first(block),
                          hint="Write X and Y here.")  # fmt: skip
    here = state.position[0], state.position[1]
    if not state.absolute:
        return polar_step(block, here)
    if here == (0.0, 0.0) and "^" not in block.values:
        raise _no_angle(block, "Write ^ too, the angle in degrees.")
    return polar_point(block, here)


def polar_point(block: Block, here: Point) -> Point:
    """Return the point at the line's distance and angle; those of ``here`` where a word is missing."""
    distance = block.values.get("@", hypot(*here))
    angle = radians(block.values["^"]) if "^" in block.values else atan2(here[1], here[0])
    return distance * cos(angle), distance * sin(angle)


def polar_step(block: Block, here: Point, *, nothing_stays: bool = False) -> Point:
    """Return ``here`` moved by the line's distance, then turned by its angle.

    A word of value 0 counts as none where ``nothing_stays``.

    Raises
    ------
    ModalConflictError
        For a step that begins at the origin.
    """
    for letter in "@^":
        step = block.values.get(letter)
        if step is None or (nothing_stays and step == 0.0):
            continue
        if here == (0.0, 0.0):
            raise _no_angle(block, "Write G90, or leave the origin before it.")
        distance, angle = hypot(*here), atan2(here[1], here[0])
        if letter == "@":
            distance += step
        else:
            angle += radians(step)
        here = distance * cos(angle), distance * sin(angle)
    return here


def _first(block: Block) -> str:
    return "@" if "@" in block.values else "^"


def _no_angle(block: Block, hint: str) -> ModalConflictError:
    return block.fault(ModalConflictError, "the origin has no angle to start from", _first(block), hint=hint)
