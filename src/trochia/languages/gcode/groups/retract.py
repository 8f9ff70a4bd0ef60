"""G98, G99: where a canned cycle retracts to.  In: nothing.  Out: a remark, and the state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _use(name: str, *, to_r: bool) -> Handler:
    def use(block: Block, state: State, sink: Sink) -> None:
        del block
        state.retract_to_r = to_r
        sink.comment(f"interpreter: retract mode set to {name}")

    return use


G_CODES = table(
    Code(
        name="G98",
        about="cycles retract to where they began",
        group="retract",
        step="retract",
        run=_use("old_z", to_r=False),
    ),
    Code(name="G99", about="cycles retract to R", group="retract", step="retract", run=_use("r_plane", to_r=True)),
)
