"""T, M6, M61: choose a tool, change it, name the one in the spindle.  Out: select_tool, change_tool.

In: tools of the table; without a table every number is a tool, without length or diameter.
"""

from __future__ import annotations

from math import floor
from typing import TYPE_CHECKING

from trochia.errors import ParseError
from trochia.languages.gcode.codes import Code, WordCode, table
from trochia.program.tools import NO_TOOL, Tool

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def select(block: Block, state: State, sink: Sink) -> None:
    """T: make a tool ready."""
    tool = round(block.values["t"])
    slot_of(tool, block, state, "t")
    state.tool = tool
    sink.select_tool(tool)


def change(block: Block, state: State, sink: Sink) -> None:
    """M6: put the tool of the last T into the spindle, which stops."""
    sink.start_change()
    state.direction = 0
    sink.stop_spindle()
    sink.change_tool(_load(state.tool, block, state, "M6"), state.tool)


def name(block: Block, state: State, sink: Sink) -> None:
    """M61: take note of the tool in the spindle."""
    tool = floor(block.values.get("q", -1.0) + 0.5)
    if tool < 0:
        raise block.fault(ParseError, "M61 needs the tool's number as Q", "M61",
                          hint="Write it like M61 Q3; M61 Q0 says that the spindle is empty.")  # fmt: skip
    state.tool = tool
    sink.change_tool_number(_load(tool, block, state, "q"), tool)


def _load(number: int, block: Block, state: State, word: str) -> int:
    """Note the tool in the spindle; return its place in the table, or its number where there is no table."""
    slot = slot_of(number, block, state, word)
    state.loaded, state.slot = number, slot
    state.in_spindle = state.tools[slot - 1] if state.tools is not None and number else NO_TOOL
    return slot


def slot_of(number: int, block: Block, state: State, word: str) -> int:
    """Return the place of a tool in the table, from 1, or its number where there is no table; 0: no tool.

    Raises
    ------
    ParseError
        Where the table lacks the tool.
    """
    if number == 0:
        return 0
    tools = state.tools
    if tools is None and number > 0:
        return number
    for slot, tool in enumerate(tools or (), start=1):
        if tool.number == number:
            return slot
    raise block.fault(ParseError, f"there is no tool {number} in the tool table", word, hint=_known(tools or []))


def _known(tools: list[Tool]) -> str:
    """Return what the table has, as a hint."""
    numbers = " ".join(f"T{tool.number}" for tool in tools[:20])
    return f"It has {numbers or 'no tools'}{' and others' if len(tools) > 20 else ''}: add a line to its file."


T = WordCode(letter="t", about="tool number", step="tool", run=select)

M_CODES = table(
    Code(name="M6", about="change the tool", group="tool change", step="tool change", run=change),
    Code(name="M61", about="the tool in the spindle is Q", group="tool change", step="tool change", run=name,
         words="q"),
)  # fmt: skip
