"""S, G97, M3, M4, M5: spindle or beam.  Out: set_spindle_speed, start_spindle, stop_spindle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, WordCode, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def set_speed(block: Block, state: State, sink: Sink) -> None:
    """S: speed of the spindle, or power of the beam."""
    state.speed = block.values["s"]
    sink.set_spindle_speed(state.speed)


def constant_speed(block: Block, state: State, sink: Sink) -> None:
    """G97: S is the speed itself, as it is from the beginning."""
    del block, state
    sink.set_spindle_mode()


def _start(direction: int) -> Handler:
    def start(block: Block, state: State, sink: Sink) -> None:
        del block
        state.direction = direction
        sink.start_spindle(direction)

    return start


def stop(block: Block, state: State, sink: Sink) -> None:
    """M5: stop the spindle, put the beam out."""
    del block
    state.direction = 0
    sink.stop_spindle()


S = WordCode(letter="s", about="spindle speed or beam power", step="speed", run=set_speed)

G_CODES = table(
    Code(name="G97", about="S is the speed", group="spindle mode", step="spindle mode", run=constant_speed),
)
M_CODES = table(
    Code(name="M3", about="spindle clockwise, beam on", group="spindle", step="spindle", run=_start(+1)),
    Code(name="M4", about="spindle counter-clockwise", group="spindle", step="spindle", run=_start(-1)),
    Code(name="M5", about="spindle or beam off", group="spindle", step="spindle", run=stop),
)
