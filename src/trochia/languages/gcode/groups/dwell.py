"""G4: wait.  In: P [s].  Out: dwell."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def dwell(block: Block, state: State, sink: Sink) -> None:
    """G4: wait for P seconds."""
    del state
    sink.dwell(block.values["p"])


G_CODES = table(Code(name="G4", about="wait for P seconds", group="non-modal", step="dwell", run=dwell, words="p"))
