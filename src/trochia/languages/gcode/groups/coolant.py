"""M7, M8, M9: coolant.  Out: mist, flood."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def mist_on(block: Block, state: State, sink: Sink) -> None:
    """M7."""
    del block
    state.mist = True
    sink.mist(on=True)


def flood_on(block: Block, state: State, sink: Sink) -> None:
    """M8."""
    del block
    state.flood = True
    sink.flood(on=True)


def off(block: Block, state: State, sink: Sink) -> None:
    """M9: both off."""
    del block
    state.mist = state.flood = False
    sink.mist(on=False)
    sink.flood(on=False)


M_CODES = table(
    Code(name="M7", about="mist on", group="coolant", step="coolant", run=mist_on),
    Code(name="M8", about="flood on", group="coolant", step="coolant", run=flood_on),
    Code(name="M9", about="mist and flood off", group="coolant", step="coolant", run=off),
)
