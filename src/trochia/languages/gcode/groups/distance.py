"""G90, G91 and their .1: what axis and centre words are measured from.  Out: the reference's comments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _targets(*, absolute: bool) -> Handler:
    def change(block: Block, state: State, sink: Sink) -> None:
        del block
        if state.absolute != absolute:
            sink.comment(f"interpreter: distance mode changed to {_name(absolute=absolute)}")
        state.absolute = absolute

    return change


def _centres(*, absolute: bool) -> Handler:
    def change(block: Block, state: State, sink: Sink) -> None:
        del block
        if state.arc_absolute != absolute:
            sink.comment(f"interpreter: IJK distance mode changed to {_name(absolute=absolute)}")
        state.arc_absolute = absolute

    return change


def _name(*, absolute: bool) -> str:
    return "absolute" if absolute else "incremental"


G_CODES = table(
    Code(name="G90", about="absolute targets", group="distance", step="distance", run=_targets(absolute=True)),
    Code(name="G91", about="incremental targets", group="distance", step="distance", run=_targets(absolute=False)),
    Code(name="G90.1", about="absolute arc centres", group="arc distance", step="arc distance",
         run=_centres(absolute=True)),
    Code(name="G91.1", about="arc centres from the start", group="arc distance", step="arc distance",
         run=_centres(absolute=False)),
)  # fmt: skip
