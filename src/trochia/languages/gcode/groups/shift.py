"""G52, G92 and its .1 .2 .3: a shift of all coordinate systems.  Out: set_g92_offset; the machine stays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.frames import in_mm, in_program_units

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def set_here(block: Block, state: State, sink: Sink) -> None:
    """G92: call the current point by the given coordinates."""
    shift = state.shift.copy()
    for axis, value in block.axes.items():
        shift[axis] += state.position[axis] - value
    state.stored_shift = in_mm(state, shift)
    _apply(shift, state, sink)


def set_to(block: Block, state: State, sink: Sink) -> None:
    """G52: shift by the given coordinates."""
    shift = state.shift.copy()
    for axis, value in block.axes.items():
        shift[axis] = value
    state.stored_shift = in_mm(state, shift)
    _apply(shift, state, sink)


def clear(block: Block, state: State, sink: Sink) -> None:
    """G92.1: no shift, and forget it."""
    state.stored_shift = [0.0] * len(state.shift)
    suspend(block, state, sink)


def suspend(block: Block, state: State, sink: Sink) -> None:
    """G92.2: no shift, but keep it for G92.3."""
    del block
    _apply([0.0] * len(state.shift), state, sink, on=False)


def restore(block: Block, state: State, sink: Sink) -> None:
    """G92.3: apply the kept shift."""
    del block
    _apply(in_program_units(state, state.stored_shift), state, sink)


def _apply(shift: list[float], state: State, sink: Sink, *, on: bool = True) -> None:
    """Use another shift; the current point gets other coordinates."""
    state.position = [
        value + old - new for value, old, new in zip(state.position, state.shift, shift, strict=True)
    ]  # fmt: skip
    state.shift = shift
    state.shift_on = on
    sink.set_g92_offset(shift)


G_CODES = table(
    Code(name="G52", about="shift by these coordinates", group="non-modal", step="non-modal", run=set_to,
         takes_axes=True),
    Code(name="G92", about="call the current point by these coordinates", group="non-modal", step="non-modal",
         run=set_here, takes_axes=True),
    Code(name="G92.1", about="no shift, forget it", group="shift", step="shift", run=clear),
    Code(name="G92.2", about="no shift, keep it", group="shift", step="shift", run=suspend),
    Code(name="G92.3", about="apply the kept shift", group="shift", step="shift", run=restore),
)  # fmt: skip
