"""G17, G18, G19: the plane of arcs.  Out: select_plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table
from trochia.program.modes import Plane

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _select(plane: Plane) -> Handler:
    def select(block: Block, state: State, sink: Sink) -> None:
        del block
        state.plane = plane
        sink.select_plane(plane)

    return select


G_CODES = table(
    Code(name="G17", about="XY plane", group="plane", step="plane", run=_select(Plane.XY)),
    Code(name="G18", about="ZX plane", group="plane", step="plane", run=_select(Plane.ZX)),
    Code(name="G19", about="YZ plane", group="plane", step="plane", run=_select(Plane.YZ)),
)
