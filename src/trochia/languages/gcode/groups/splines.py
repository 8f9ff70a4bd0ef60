"""G5, G5.1: Bezier curves; G5.2, G5.3: rational B-splines.  In: control points.  Out: nurbs_feed.

G5 is cubic: I J from the start to the first control point, P Q from the end to the second.  G5.1 is quadratic: I J from
the start to its one control point.  G5.2 begins a curve at the current point; each line after it adds a control point
with its weight P; G5.3 ends it.  All lie in the XY plane.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.groups.motion import target_of
from trochia.languages.gcode.state import NO_MOTION
from trochia.program.modes import Plane, TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_NURBS = 52  # G5.2 in tenths
_ORDER = 3  # of a curve without L, and the least
_IN_PLANE = (0, 1)


def cubic(block: Block, state: State, sink: Sink) -> None:
    """G5: cubic Bezier curve; without I J it goes on as the G5 before it ended."""
    end = _bezier_end(block, state)
    if "p" not in block.values or "q" not in block.values:
        raise block.fault(ParseError, "G5 needs P and Q", block.mover,
                          hint="They lead from the end to the second control point.")  # fmt: skip
    if ("i" in block.values) != ("j" in block.values):
        raise block.fault(ParseError, "G5 needs I and J, or neither", block.mover,
                          hint="They lead from the start to the first control point.")  # fmt: skip
    start = state.position
    first, back = state.spline_end, (block.values["p"], block.values["q"])
    if "i" in block.values:
        first = block.values["i"], block.values["j"]
    points = [
        (start[0], start[1], 1.0),
        (start[0] + first[0], start[1] + first[1], 1.0),
        (end[0] + back[0], end[1] + back[1], 1.0),
        (end[0], end[1], 1.0),
    ]
    _send(block, state, sink, points, len(points), end)
    state.spline_end = -back[0], -back[1]


def quadratic(block: Block, state: State, sink: Sink) -> None:
    """G5.1: quadratic Bezier curve."""
    end = _bezier_end(block, state)
    if "i" not in block.values or "j" not in block.values:
        raise block.fault(ParseError, "G5.1 needs I and J", block.mover,
                          hint="They lead from the start to the control point.")  # fmt: skip
    start = state.position
    middle = start[0] + block.values["i"], start[1] + block.values["j"], 1.0
    points = [(start[0], start[1], 1.0), middle, (end[0], end[1], 1.0)]
    _send(block, state, sink, points, len(points), end)


def add_point(block: Block, state: State, sink: Sink) -> None:
    """G5.2: begin a curve, or add a control point to it."""
    del sink
    if state.feed == 0.0:
        raise block.fault(ModalConflictError, "a spline has no feed", block.mover,
                          hint="Write F, like F100, before it.")  # fmt: skip
    weight = block.values.get("p", 1.0)
    if state.motion == _NURBS:
        if "p" not in block.values or weight <= 0.0:
            raise block.fault(ParseError, "each control point needs its weight: P, above 0", block.mover,
                              hint="Write P1 for a plain one.")  # fmt: skip
    else:
        weight = weight if weight > 0.0 else 1.0
        state.spline_order = max(round(block.values.get("l", _ORDER)), _ORDER)
        state.spline_points = [(state.position[0], state.position[1], weight)]
    if block.axes:
        if not all(column in block.axes for column in _IN_PLANE):
            raise block.fault(ParseError, "a control point needs X and Y", block.mover,
                              hint="Write both, even where one of them stays.")  # fmt: skip
        point = target_of(block, state)
        state.spline_points.append((point[0], point[1], weight))
    state.motion = _NURBS


def end_curve(block: Block, state: State, sink: Sink) -> None:
    """G5.3: send the curve that G5.2 began."""
    points, order = state.spline_points, state.spline_order
    if state.motion != _NURBS:
        raise block.fault(ModalConflictError, "G5.3 ends no curve", "G5.3", hint="A curve begins with G5.2.")
    if block.axes:
        raise block.fault(ParseError, "G5.3 takes no axis words", "G5.3",
                          hint="Control points stand on the lines before it.")  # fmt: skip
    if len(points) < order:
        raise block.fault(ModalConflictError, f"a curve of order {order} needs {order} control points, the start "
                          f"among them; it has {len(points)}", "G5.3",
                          hint="Add points, or write a smaller L.")  # fmt: skip
    end = state.position.copy()
    end[0], end[1] = points[-1][0], points[-1][1]
    sink.nurbs_feed(points, order, end)
    state.position = end
    state.motion = NO_MOTION


def _bezier_end(block: Block, state: State) -> list[float]:
    """Return the end of a Bezier curve, after checking what both kinds ask."""
    if state.law == TimeLaw.INVERSE:
        if "f" not in block.values:
            raise block.fault(ParseError, "in inverse time (G93) every feed move needs its own F", block.mover,
                              hint="Write F, in moves per minute, or go back to G94.")  # fmt: skip
    elif state.feed == 0.0:
        raise block.fault(ModalConflictError, "a spline has no feed", block.mover,
                          hint="Write F, like F100, on this line or before it.")  # fmt: skip
    if state.plane != Plane.XY:
        raise block.fault(ModalConflictError, "splines lie in the XY plane only", block.mover,
                          hint="Write G17 before it.")  # fmt: skip
    end = target_of(block, state)
    if end[2:] != state.position[2:]:
        raise block.fault(ParseError, "a spline moves X and Y only", block.mover,
                          hint="Move the other axes on a line of their own.")  # fmt: skip
    return end


def _send(  # noqa: PLR0917
    block: Block, state: State, sink: Sink, points: list[tuple[float, float, float]], order: int, end: list[float]
) -> None:
    """Send a Bezier curve; the motion code before it stays in force."""
    if state.law == TimeLaw.INVERSE:
        sink.set_spline_time(block.values["f"])
    sink.nurbs_feed(points, order, end)
    state.position = end
    state.cycle_words["initial"] = end[state.plane.normal]  # where a cycle that goes on begins anew


def _check(block: Block, state: State) -> None:
    """Check the words before anything acts."""
    del state
    assert block.motion is not None
    if not block.has_target:
        raise block.fault(ParseError, f"{block.motion.name} has no axis word", block.motion.name,
                          hint="Write where the curve ends, like X10 Y5.")  # fmt: skip


_GROUP = "motion"
G_CODES = table(
    Code(name="G5", about="cubic spline", group=_GROUP, step=_GROUP, run=cubic, words="ijpq", check=_check),
    Code(name="G5.1", about="quadratic spline", group=_GROUP, step=_GROUP, run=quadratic, words="ij", check=_check),
    Code(name="G5.2", about="begin a NURBS curve, or add a control point", group=_GROUP, step=_GROUP, run=add_point,
         words="pl"),
    Code(name="G5.3", about="end a NURBS curve", group=_GROUP, step=_GROUP, run=end_curve),
)  # fmt: skip
