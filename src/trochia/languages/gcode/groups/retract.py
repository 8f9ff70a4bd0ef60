"""G98, G99: where a canned cycle retracts to.  No cycle reads it yet; files have it in their first line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _use(name: str) -> Handler:
    def use(block: Block, state: State, sink: Sink) -> None:
        del block, state
        sink.comment(f"interpreter: retract mode set to {name}")

    return use


G_CODES = table(
    Code(name="G98", about="cycles retract to where they began", group="retract", step="retract", run=_use("old_z")),
    Code(name="G99", about="cycles retract to R", group="retract", step="retract", run=_use("r_plane")),
)
