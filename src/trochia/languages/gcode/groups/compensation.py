"""G40: cutter radius compensation off, which it always is.  Out: the comment the reference prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def off(block: Block, state: State, sink: Sink) -> None:
    """G40: no cutter radius compensation."""
    del block, state
    sink.comment("interpreter: cutter radius compensation off")


G_CODES = table(Code(name="G40", about="no cutter compensation", group="compensation", step="compensation", run=off))
