"""G0, G1, G80, and G53: straight moves.  In: axis words.  Out: straight_traverse, straight_feed."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.frames import base_of, turned
from trochia.languages.gcode.polar import polar_target
from trochia.languages.gcode.state import NO_MOTION
from trochia.program.modes import TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_Z = 2
LEAST_INVERSE_RATE = 0.1  #: units/min an inverse-time move gets at least


def traverse(block: Block, state: State, sink: Sink) -> None:
    """G0: go straight, as fast as the axes can."""
    end = target_of(block, state)
    sink.straight_traverse(end)
    state.position = end
    state.straight_next = False
    state.motion = 0


def feed(block: Block, state: State, sink: Sink) -> None:
    """G1: go straight at the feed."""
    end = target_of(block, state)
    require_feed(block, state)
    if state.law == TimeLaw.INVERSE:
        set_inverse_time(block, sink, _length(state.position, end))
    sink.straight_feed(end)
    state.position = end
    state.straight_next = False
    state.motion = 10


def cancel(block: Block, state: State, sink: Sink) -> None:
    """G80: no motion code is in force any more."""
    del block
    sink.comment("interpreter: motion mode set to none")
    state.motion = NO_MOTION


def use_machine_coordinates(block: Block, state: State, sink: Sink) -> None:
    """G53: the targets of this line are machine coordinates."""
    del state, sink
    block.in_machine = True


def target_of(block: Block, state: State) -> list[float]:
    """Return where the axis words lead (9), program coordinates."""
    end = state.position.copy()
    if block.in_machine and not block.is_polar:
        return _machine_target(block.axes, state)
    if state.absolute:
        for axis, value in block.axes.items():
            end[axis] = value
    else:
        for axis, value in block.axes.items():
            end[axis] += value
    if len(block.values) > len(block.axes) and block.is_polar:
        end[0], end[1] = polar_target(block, state)
    return end


def require_feed(block: Block, state: State) -> None:
    """Check that a feed move has a feed.

    Raises
    ------
    ModalConflictError
        Without a feed, or per revolution of a spindle at speed zero.
    ParseError
        In inverse time without an F word on the line.
    """
    if state.law == TimeLaw.INVERSE:
        if "f" not in block.values:
            raise block.fault(ParseError, "in inverse time (G93) every feed move needs its own F", block.mover,
                              hint="Write F, in moves per minute, or go back to G94.")  # fmt: skip
    elif state.feed == 0.0:
        raise block.fault(ModalConflictError, "this move has no feed", block.mover, hint=_feed_hint(block, state))
    elif state.law == TimeLaw.PER_REV and state.speed == 0.0:
        raise block.fault(ModalConflictError, "feed per revolution (G95), but the spindle speed is zero", block.mover,
                          hint="Write S, and M3 or M4, before it.")  # fmt: skip


def _feed_hint(block: Block, state: State) -> str:
    """Return what to write where the feed is missing."""
    changed = (
        "; G94 and G95 set the feed to zero" if state.law == TimeLaw.PER_REV or "feed mode" in block.groups else ""
    )
    return f"Write F, like F500, on this line or before it{changed}."


def set_inverse_time(block: Block, sink: Sink, length: float) -> None:
    """Tell the sink the feed of a move of that length [units] in inverse time."""
    per_minute = block.values["f"]
    sink.set_inverse_time(per_minute, max(LEAST_INVERSE_RATE, length * per_minute))


def _machine_target(words: dict[int, float], state: State) -> list[float]:
    """Return program coordinates of a target whose words are machine coordinates in program units."""
    base = base_of(state)
    shifted = [value + shift for value, shift in zip(state.position, state.shift, strict=True)]
    point = [value + here for value, here in zip(turned(shifted, state.rotation), base, strict=True)]
    for axis, value in words.items():
        point[axis] = value + unseen_offset(state, axis)
    point = turned([value - here for value, here in zip(point, base, strict=True)], -state.rotation)
    return [value - shift for value, shift in zip(point, state.shift, strict=True)]


def unseen_offset(state: State, axis: int) -> float:
    """Return what the reference leaves out of machine coordinates: tool offsets of axes other than X Y Z."""
    return state.tool_offset[axis] if axis > _Z else 0.0


def _length(start: list[float], end: list[float]) -> float:
    """Return the length that feed is measured along: X Y Z, else U V W, else A B C."""
    steps = [b - a for a, b in zip(start, end, strict=True)]
    linear = hypot(*steps[0:3])
    return linear or hypot(*steps[6:9]) or hypot(*steps[3:6])


G_CODES = table(
    Code(name="G0", about="rapid move", group="motion", step="motion", run=traverse),
    Code(name="G1", about="straight feed move", group="motion", step="motion", run=feed),
    Code(name="G80", about="no motion mode", group="motion", step="motion", run=cancel),
    Code(name="G53", about="targets in machine coordinates", group="non-modal", step="non-modal",
         run=use_machine_coordinates),
)  # fmt: skip
