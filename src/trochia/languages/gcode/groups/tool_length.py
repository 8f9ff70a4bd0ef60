"""G43, G43.1, G43.2, G49: the offset of the tool's tip.

In: H, a tool of the table, or axis words.  Out: use_tool_length_offset; the machine stays, and the current point gets
other coordinates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.frames import in_program_units, turned
from trochia.languages.gcode.groups.tool import slot_of
from trochia.languages.gcode.numbers import as_integer
from trochia.program.tools import NO_TOOL, Tool

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_NONE = (0.0,) * 9


def of_table(block: Block, state: State, sink: Sink) -> None:
    """G43: the offset of tool H, or of the tool in the spindle."""
    tool = _tool_of(block, state) if "h" in block.values else state.in_spindle
    use(in_program_units(state, tool.offset), state, sink)


def of_words(block: Block, state: State, sink: Sink) -> None:
    """G43.1: the offset is given by the axis words; axes without one keep theirs."""
    offset = state.tool_offset.copy()
    for axis, value in block.axes.items():
        offset[axis] = value
    use(offset, state, sink)


def add(block: Block, state: State, sink: Sink) -> None:
    """G43.2: add the offset of tool H.  Axis words in its place are refused, as the reference does."""
    if "h" not in block.values:
        raise block.fault(ParseError, "G43.2 has no H", "G43.2",
                          hint="Write the tool that is added, like G43.2 H4; G43.1 has axis words.")  # fmt: skip
    if block.axes:
        raise block.fault(ModalConflictError, "G43.2 takes H, or axis words, not both", "G43.2",
                          hint="Use two lines.")  # fmt: skip
    more = in_program_units(state, _tool_of(block, state).offset)
    use([old + extra for old, extra in zip(state.tool_offset, more, strict=True)], state, sink)


def cancel(block: Block, state: State, sink: Sink) -> None:
    """G49: no tool offset."""
    del block
    use(_NONE, state, sink)


def use(offset: Sequence[float], state: State, sink: Sink) -> None:
    """Let an offset (9) [program units] act."""
    change = turned([old - new for old, new in zip(state.tool_offset, offset, strict=True)], -state.rotation)
    state.position = [value + step for value, step in zip(state.position, change, strict=True)]
    state.tool_offset = list(offset)
    sink.use_tool_length_offset(offset)


def _tool_of(block: Block, state: State) -> Tool:
    """Return the tool that H names; H0 is the one in the spindle."""
    number = as_integer(block.values["h"])
    if number is None:
        raise block.fault(ParseError, f"H{block.values['h']:g} is no tool number", "h",
                          hint="Tools have whole numbers.")  # fmt: skip
    if number == 0:
        return state.in_spindle
    slot = slot_of(number, block, state, "h")
    return NO_TOOL if state.tools is None else state.tools[slot - 1]


_GROUP = "tool length"
G_CODES = table(
    Code(name="G43", about="offset of tool H", group=_GROUP, step=_GROUP, run=of_table, words="h"),
    Code(name="G43.1", about="offset by axis words", group=_GROUP, step=_GROUP, run=of_words),
    Code(name="G43.2", about="add the offset of tool H", group=_GROUP, step=_GROUP, run=add, words="h"),
    Code(name="G49", about="no tool offset", group=_GROUP, step=_GROUP, run=cancel),
)
