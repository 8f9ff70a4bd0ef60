"""G7, G8: X words of a lathe are diameters, or radii.  Out: a remark; the check halves the words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_STEP = "diameter mode"


def _use(*, diameter: bool) -> Handler:
    def use(block: Block, state: State, sink: Sink) -> None:
        del block
        if state.diameter != diameter:
            state.diameter = diameter
            sink.comment(f"interpreter: Lathe diameter mode changed to {'diameter' if diameter else 'radius'}")

    return use


def halve(block: Block, state: State) -> None:
    """Turn the X word of the line from a diameter into a radius, where diameters are in force on it."""
    code = block.groups.get(_STEP)
    diameter = state.diameter if code is None else code.name == "G7"
    if diameter and 0 in block.axes:
        block.axes[0] = block.values["x"] = 0.5 * block.axes[0]


G_CODES = table(
    Code(name="G7", about="X words are diameters", group=_STEP, step=_STEP, run=_use(diameter=True)),
    Code(name="G8", about="X words are radii", group=_STEP, step=_STEP, run=_use(diameter=False)),
)
