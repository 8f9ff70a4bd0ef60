"""G2 and G3: arcs and helices.  In: end, and centre (I J K) or radius (R), and P turns.  Out: arc_feed.

Which arcs are refused follows LinuxCNC 2.9; found by bisection against its stand-alone interpreter.
"""

from __future__ import annotations

from math import atan2, hypot, sqrt, tau
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.groups.motion import require_feed, set_inverse_time, target_of
from trochia.program.modes import AXES, TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

Point = tuple[float, float]

SHORT_RADIUS = (0.00127, 0.00005)  #: by which R may be too short, and the least radius of an arc [mm], [inch]
SPIRAL = (0.02 * sqrt(2), 0.002 * sqrt(2))  #: by which start and end radius may differ anyway [mm], [inch]
SPIRAL_MOST = (2.0 * sqrt(2), 0.2 * sqrt(2))  #: and by which they may never differ [mm], [inch]
SPIRAL_SHARE = 0.001  #: else they may differ by this share of the greater one
MOST_RADIUS = 1e150  #: by R; its square must be a number
MOST_TURNS = 1_000_000  #: of one arc
HALF_TURN = 1.0 - 1e-12  #: a chord of more than this share of the diameter counts as the diameter

_OFFSETS = "ijk"  # offset words of X, Y, Z


def clockwise(block: Block, state: State, sink: Sink) -> None:
    """G2: arc or helix, clockwise."""
    _arc(block, state, sink, -1)
    state.motion = 20


def counter_clockwise(block: Block, state: State, sink: Sink) -> None:
    """G3: arc or helix, counter-clockwise."""
    _arc(block, state, sink, +1)
    state.motion = 30


def _arc(block: Block, state: State, sink: Sink, sense: int) -> None:
    """Send the arc of this line; ``sense`` is +1 counter-clockwise, -1 clockwise."""
    if state.straight_next:
        raise block.fault(ModalConflictError, "the move behind cutter compensation must be straight", block.mover,
                          hint="Lead away from the part by G0 or G1 first.")  # fmt: skip
    form = _form_of(block, state)
    require_feed(block, state)
    end = target_of(block, state)
    first, second = state.plane.axes
    start_point = state.position[first], state.position[second]
    end_point = end[first], end[second]
    if form == "radius":
        centre = _centre_by_radius(block, state, start_point, end_point, sense)
    else:
        centre = _centre_by_offsets(block, state, start_point)
        check_radii(block, state, start_point, end_point, centre)
    turns = sense * round(block.values.get("p", 1.0))
    if abs(turns) > MOST_TURNS:
        raise block.fault(ParseError, f"an arc of more than {MOST_TURNS:,} turns", "p", hint="P counts whole turns.")
    if state.law == TimeLaw.INVERSE:
        climb = end[state.plane.normal] - state.position[state.plane.normal]
        set_inverse_time(block, sink, _length(start_point, end_point, centre, turns, climb))
    sink.arc_feed(end, centre, turns, state.plane)
    state.position = end


def _form_of(block: Block, state: State) -> str:
    """Return ``radius`` or ``centre``, by the words of the line."""
    plane = "".join(AXES[axis] for axis in sorted(state.plane.axes))
    first, second = (_OFFSETS[axis] for axis in sorted(state.plane.axes))
    offsets = [letter for letter in _OFFSETS if letter in block.values]
    if "r" in block.values:
        if offsets:
            raise block.fault(ParseError, f"R and {offsets[0].upper()} cannot both say where the centre is", "r",
                              hint="Use R alone, or I J K alone.")  # fmt: skip
        if not block.is_polar and not any(axis in block.axes for axis in state.plane.axes):
            raise block.fault(ParseError, f"an arc by R needs its end: {plane[0]} or {plane[1]}", "r",
                              hint="A whole turn needs its centre: I J K.")  # fmt: skip
        return "radius"
    if not offsets:
        raise block.fault(ParseError, "an arc needs its centre or its radius", block.mover,
                          hint=f"Write {first.upper()} {second.upper()}, or R; or G1 for a line.")  # fmt: skip
    for letter in offsets:
        if letter not in (first, second):
            raise block.fault(ParseError, f"{letter.upper()} has no meaning in the {plane} plane", letter,
                              hint=f"Use {first.upper()} {second.upper()}, or change the plane.")  # fmt: skip
    for letter in (first, second):
        if state.arc_absolute and letter not in block.values:
            raise block.fault(ParseError, f"an absolute centre (G90.1) needs {letter.upper()} too", block.mover,
                              hint=f"Write {letter.upper()}, or measure the centre from the start: G91.1.")  # fmt: skip
    return "centre"


def _centre_by_offsets(block: Block, state: State, start: Point) -> Point:
    """Return the centre given by I J K."""
    first, second = (_OFFSETS[axis] for axis in state.plane.axes)
    if state.arc_absolute:
        return block.values[first], block.values[second]
    return start[0] + block.values.get(first, 0.0), start[1] + block.values.get(second, 0.0)


def check_radii(block: Block, state: State, start: Point, end: Point, centre: Point) -> None:
    """Check that start and end are as far from the centre.

    Raises
    ------
    ModalConflictError
        Where they are not, or one of them lies on it.
    """
    begin_radius = _distance(start[0] - centre[0], start[1] - centre[1])
    end_radius = _distance(end[0] - centre[0], end[1] - centre[1])
    unit = "inch" if state.inch else "mm"
    if min(begin_radius, end_radius) < SHORT_RADIUS[state.inch]:
        raise block.fault(ModalConflictError, f"an arc of radius {min(begin_radius, end_radius):.5f} {unit}",
                          block.mover, hint="Start or end lies on the centre.")  # fmt: skip
    difference = abs(begin_radius - end_radius)
    share = difference / max(begin_radius, end_radius)
    if difference > SPIRAL_MOST[state.inch] or (difference > SPIRAL[state.inch] and share > SPIRAL_SHARE):
        raise block.fault(ModalConflictError, f"the arc begins at radius {begin_radius:.4f} {unit} and ends at "
                          f"{end_radius:.4f} {unit}", block.mover,
                          hint=f"They may differ by {SPIRAL[state.inch]:.4f} {unit} or by {SPIRAL_SHARE:.1%}: correct "
                          "the end or the centre.")  # fmt: skip


def _centre_by_radius(block: Block, state: State, start: Point, end: Point, sense: int) -> Point:
    """Return the centre of the arc of radius R: at most half a turn for R > 0, at least half for R < 0.

    The centre lies on the chord's perpendicular bisector, sqrt(R^2 - (chord/2)^2) from it.
    """
    radius = block.values["r"]
    across, up = end[0] - start[0], end[1] - start[1]
    chord = _distance(across, up)
    if chord == 0.0:
        raise block.fault(ModalConflictError, "an arc by R must not end where it begins", "r",
                          hint="A whole turn needs its centre: I J K.")  # fmt: skip
    if max(chord, abs(radius)) > MOST_RADIUS:
        raise block.fault(ModalConflictError, f"an arc by R of radius {abs(radius):g} over a chord of {chord:g} has no "
                          "centre within all numbers", "r", hint="Use G1.")  # fmt: skip
    if chord / 2 - abs(radius) > SHORT_RADIUS[state.inch]:
        raise block.fault(ModalConflictError, f"radius {abs(radius):g} does not reach over a chord of {chord:.4f}", "r",
                          hint=f"R must be at least {chord / 2:.4f}.")  # fmt: skip
    half, size = chord / 2, abs(radius)
    away = 0.0 if half > size * HALF_TURN else sqrt(size * size - half * half)
    left = away / chord * (sense if radius > 0 else -sense)
    return (start[0] + end[0]) / 2 - up * left, (start[1] + end[1]) / 2 + across * left


def _distance(x: float, y: float) -> float:
    """Return the length of a vector; not ``hypot``, whose last bit the plain-line reader in C would not repeat."""
    return sqrt(x * x + y * y)


def _length(start: Point, end: Point, centre: Point, turns: int, climb: float) -> float:
    """Return the length of a helix with the start's radius."""
    begin = atan2(start[1] - centre[1], start[0] - centre[0])
    angle = (atan2(end[1] - centre[1], end[0] - centre[0]) - begin) * (1 if turns > 0 else -1)
    swept = angle % tau or tau
    swept += (abs(turns) - 1) * tau
    return hypot(swept * hypot(start[0] - centre[0], start[1] - centre[1]), climb)


G_CODES = table(
    Code(name="G2", about="arc or helix, clockwise", group="motion", step="motion", run=clockwise, words="ijkrp"),
    Code(name="G3", about="arc or helix, counter-clockwise", group="motion", step="motion", run=counter_clockwise,
         words="ijkrp"),
)  # fmt: skip
