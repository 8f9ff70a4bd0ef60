"""G10: set coordinate systems and tools from the program.

In: L (what is set), P (of which system or tool), axis words, R, I, J, Q.  Out: set_g5x_offset and set_xy_rotation, or
set_tool_table_entry; the machine stays.
"""

from __future__ import annotations

from dataclasses import replace
from math import floor
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.frames import in_mm, in_program_units, to_machine, to_program, turned
from trochia.languages.gcode.groups.coordinates import activate
from trochia.languages.gcode.groups.tool import slot_of
from trochia.languages.gcode.numbers import as_integer
from trochia.program.work import SYSTEMS

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State
    from trochia.program.tools import Tool

_FIXTURE = 9  # G59.3, from which L11 measures
_MOST_ORIENTATION = 9
_KINDS = (0, 1, 2, 10, 11, 20)
_NEAR = 1e-4 * (1 + 1e-9)  # by which P may miss an integer
_WHAT = "L2 sets an origin, L20 makes the current point read so; L1, L10 and L11 set a tool; L0 reads the tools anew."


def set_data(block: Block, state: State, sink: Sink) -> None:
    """G10."""
    kind = int(block.values["l"])
    if kind == 0:
        _reload(block, state, sink)
    elif kind in (2, 20):
        _set_system(block, state, sink, to_here=kind == 20)
    else:
        _set_tool(block, state, sink, kind)


def check_data(block: Block, state: State) -> None:
    """Check what is to be set, before anything on the line acts.

    Raises
    ------
    ParseError
        For an L that is not known, and a P that is no number of a system or tool.
    """
    del state
    kind, number = int(block.values.get("l", -1)), block.values.get("p", -1.0)
    whole = floor(number + 0.5)
    if kind not in _KINDS:
        raise block.fault(ParseError, "G10 needs L0, L1, L2, L10, L11 or L20", "l" if "l" in block.values else "G10",
                          hint=_WHAT)  # fmt: skip
    if kind and "p" in block.values and number - whole > _NEAR:
        raise block.fault(ParseError, "P of G10 must be a whole number", "p",
                          hint="It numbers a coordinate system or a tool.")  # fmt: skip
    if kind in (2, 20) and not 0 <= whole <= len(SYSTEMS):
        raise block.fault(ParseError, "G10 L2 and L20 need P from 0 to 9", "p" if "p" in block.values else "G10",
                          hint="P1 is G54, P2 G55 … P9 G59.3; P0 the one in force.")  # fmt: skip
    if kind in (1, 10, 11) and whole < 1:
        raise block.fault(ParseError, f"G10 L{kind} needs a tool number as P", "p" if "p" in block.values else "G10",
                          hint=f"Write it like G10 L{kind} P3 Z12.5.")  # fmt: skip


def _reload(block: Block, state: State, sink: Sink) -> None:
    """L0: read the tool table anew, with no tool in the spindle whose data could change under it."""
    number = state.loaded or state.in_spindle.number
    if number:
        raise block.fault(ModalConflictError, f"tool {number} is in the spindle, so the tool table cannot be read anew",
                          "G10", hint="Put it away first: T0 M6.")  # fmt: skip
    sink.reload_tools()


def _set_system(block: Block, state: State, sink: Sink, *, to_here: bool) -> None:
    """L2: the origin is at the words; L20: the current point reads the words."""
    system = int(block.values["p"] + _NEAR)  # not the nearest one, as the reference has it
    _refuse(block, "ijr" if to_here else "ij")
    system = system or state.system
    here = to_machine(state, state.position)
    if "r" in block.values:
        state.rotations[system - 1] = block.values["r"]
    origin = in_program_units(state, state.systems[system - 1])
    if to_here:
        origin = _origin_that_reads(block, state, system, origin, here)
    else:
        for axis, value in block.axes.items():
            origin[axis] = value
    state.systems[system - 1] = in_mm(state, origin)
    if system != state.system:
        sink.comment("interpreter: setting coordinate system origin")
        return
    activate(state, system)
    state.position = to_program(state, here)
    sink.set_g5x_offset(system, state.origin)
    sink.set_xy_rotation(state.rotation)


def _origin_that_reads(block: Block, state: State, system: int, origin: list[float], here: list[float]) -> list[float]:
    """Return the origin (9) of a system in which the machine point ``here`` reads the line's axis words."""
    turn = state.rotations[system - 1]
    point = in_program_units(state, here)
    away = [value - old - tool for value, old, tool in zip(point, origin, state.tool_offset, strict=True)]
    reads = [value - shift for value, shift in zip(turned(away, -turn), state.shift, strict=True)]
    step = [0.0] * len(reads)
    for axis, value in block.axes.items():
        step[axis] = reads[axis] - value
    return [old + change for old, change in zip(origin, turned(step, turn), strict=True)]


def _set_tool(block: Block, state: State, sink: Sink, kind: int) -> None:
    """L1: the offset is given; L10, L11: with it the current point reads the words, in this system or in G59.3."""
    number = floor(block.values["p"] + 0.5)
    if state.tools is None:
        raise block.fault(ParseError, "there is no tool table to write to", "G10", hint="Name its file: --tools FILE.")
    slot = slot_of(number, block, state, "p")
    if not block.axes and block.values.keys().isdisjoint("rijq"):
        raise block.fault(ParseError, f"G10 L{kind} sets nothing", "G10",
                          hint="Write axis words, R (radius), I and J (edges) or Q (orientation).")  # fmt: skip
    tool = _changed(block, state, state.tools[slot - 1], kind)
    state.tools[slot - 1] = tool
    sink.set_tool_table_entry(slot, tool)
    if state.slot == slot:
        state.in_spindle = tool
        sink.set_tool_table_entry(0, tool)


def _changed(block: Block, state: State, tool: Tool, kind: int) -> Tool:
    """Return the tool with what the line says of it."""
    offset = in_program_units(state, tool.offset)
    if kind == 1:
        for axis, value in block.axes.items():
            offset[axis] = value
    else:
        offset = (_touch_here if kind == 10 else _touch_fixture)(block, state, offset)
    values = block.values
    return replace(
        tool,
        offset=tuple(in_mm(state, offset)),
        diameter=2 * values["r"] * state.scale if "r" in values else tool.diameter,
        front=values.get("i", tool.front),
        back=values.get("j", tool.back),
        orientation=_orientation(block) if "q" in values else tool.orientation,
    )


def _touch_here(block: Block, state: State, offset: list[float]) -> list[float]:
    """Return the offset with which the current point reads the words; axes without one keep theirs, as turned."""
    own, now = turned(offset, -state.rotation), turned(state.tool_offset, -state.rotation)
    for axis, value in block.axes.items():
        own[axis] = now[axis] + state.position[axis] - value
    return turned(own, state.rotation)


def _touch_fixture(block: Block, state: State, offset: list[float]) -> list[float]:
    """Return the offset with which the current point would read the words in G59.3, where no shift counts."""
    turn = state.rotations[_FIXTURE - 1]
    base = in_program_units(state, state.systems[_FIXTURE - 1])
    point = in_program_units(state, to_machine(state, state.position))
    away = turned([value - origin for value, origin in zip(point, base, strict=True)], -turn)
    own = turned(offset, -turn)
    for axis, value in block.axes.items():
        own[axis] = away[axis] - value
    return turned(own, turn)


def _orientation(block: Block) -> int:
    value = as_integer(block.values["q"])
    if value is None or not 0 <= value <= _MOST_ORIENTATION:
        raise block.fault(ParseError, "Q of G10 is the orientation of a turning tool, 0 to 9", "q",
                          hint="0 says that the tool is round.")  # fmt: skip
    return value


def _refuse(block: Block, letters: str) -> None:
    """Raise for a word that this G10 does not read."""
    for letter in letters:
        if letter in block.values:
            raise block.fault(ModalConflictError, f"this G10 does not read {letter.upper()}", letter, hint=_WHAT)


G_CODES = table(
    Code(name="G10", about="set coordinate systems and tools", group="non-modal", step="non-modal", run=set_data,
         words="lprijq", takes_axes=True, check=check_data),
)  # fmt: skip
