"""G20, G21: inches and millimetres.  Out: use_length_units; what the state holds in program units is converted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.frames import scaled
from trochia.languages.gcode.state import INCH

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def use_inches(block: Block, state: State, sink: Sink) -> None:
    """G20: lengths are inches from here on."""
    del block
    _change(state, inch=True)
    sink.use_length_units(inch=True)


def use_millimetres(block: Block, state: State, sink: Sink) -> None:
    """G21: lengths are millimetres from here on."""
    del block
    _change(state, inch=False)
    sink.use_length_units(inch=False)


def _change(state: State, *, inch: bool) -> None:
    """Convert positions and offsets; the feed keeps its number until the next F word."""
    if inch == state.inch:
        return
    factor = 1 / INCH if inch else INCH
    state.position = scaled(state.position, factor)
    state.origin = scaled(state.origin, factor)
    state.shift = scaled(state.shift, factor)
    state.tool_offset = scaled(state.tool_offset, factor)
    state.inch = inch
    if state.compensation is not None:
        state.compensation.rescale(factor)


G_CODES = table(
    Code(name="G20", about="lengths in inches", group="length units", step="length units", run=use_inches),
    Code(name="G21", about="lengths in millimetres", group="length units", step="length units", run=use_millimetres),
)
