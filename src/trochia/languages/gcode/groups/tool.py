"""T, M6, G49: choose a tool, change it, no tool length.  Out: select_tool, change_tool, use_tool_length_offset."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ParseError
from trochia.languages.gcode.codes import Code, WordCode, table
from trochia.languages.gcode.numbers import as_integer

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_NO_OFFSET = (0.0,) * 9


def select(block: Block, state: State, sink: Sink) -> None:
    """T: make a tool ready."""
    tool = as_integer(block.values["t"])
    if tool is None:
        raise block.fault(
            ParseError, f"T{block.values['t']:g} is no tool number", "t", hint="Tools have whole numbers."
        )
    state.tool = tool
    sink.select_tool(tool)


def change(block: Block, state: State, sink: Sink) -> None:
    """M6: put the tool of the last T into the spindle, which stops."""
    del block
    sink.start_change()
    state.direction = 0
    sink.stop_spindle()
    sink.change_tool(state.tool)


def no_length(block: Block, state: State, sink: Sink) -> None:
    """G49: no tool length offset."""
    del block, state
    sink.use_tool_length_offset(_NO_OFFSET)


T = WordCode(letter="t", about="tool number", step="tool", run=select)

G_CODES = table(Code(name="G49", about="no tool length offset", group="tool length", step="tool length", run=no_length))
M_CODES = table(Code(name="M6", about="change the tool", group="tool change", step="tool change", run=change))
