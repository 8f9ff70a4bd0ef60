"""G28, G30 and their .1: go to a stored point, and store it.

In: axis words of a point on the way.  Out: two straight_traverse.  With axis words, only those axes go on to the
stored point.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table
from trochia.languages.gcode.frames import to_machine, to_program
from trochia.languages.gcode.groups.motion import target_of, unseen_offset

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _go(home: int) -> Handler:
    def go(block: Block, state: State, sink: Sink) -> None:
        way_point = target_of(block, state)
        sink.straight_traverse(way_point)
        stored = to_program(state, state.homes[home])
        stored = [value + unseen_offset(state, axis) for axis, value in enumerate(stored)]
        axes = block.axes or range(len(stored))
        state.position = [stored[axis] if axis in axes else value for axis, value in enumerate(way_point)]
        sink.straight_traverse(state.position)

    return go


def _store(home: int) -> Handler:
    def store(block: Block, state: State, sink: Sink) -> None:
        del block, sink
        state.homes[home] = to_machine(state, state.position)

    return store


G_CODES = table(
    Code(name="G28", about="go to the first stored point", group="non-modal", step="non-modal", run=_go(28),
         takes_axes=True),
    Code(name="G28.1", about="store the first point", group="non-modal", step="non-modal", run=_store(28)),
    Code(name="G30", about="go to the second stored point", group="non-modal", step="non-modal", run=_go(30),
         takes_axes=True),
    Code(name="G30.1", about="store the second point", group="non-modal", step="non-modal", run=_store(30)),
)  # fmt: skip
