"""G54 to G59.3: coordinate systems.  Out: set_g5x_offset, set_g92_offset, set_xy_rotation; the machine stays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table
from trochia.languages.gcode.frames import in_program_units, to_machine, to_program
from trochia.program.parameter_file import ACTIVE
from trochia.program.work import SYSTEMS

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _use(system: int) -> Handler:
    def use(block: Block, state: State, sink: Sink) -> None:
        del block
        if system == state.system:
            sink.comment("interpreter: continuing to use same coordinate system")
            return
        here = to_machine(state, state.position)
        activate(state, system)
        state.position = to_program(state, here)
        sink.set_g5x_offset(system, state.origin)
        sink.set_g92_offset(state.shift)
        sink.set_xy_rotation(state.rotation)

    return use


def activate(state: State, system: int) -> None:
    """Make a stored system the active one; the current point is the caller's to convert."""
    state.system = system
    state.parameters.numbered[ACTIVE] = float(system)
    state.origin = in_program_units(state, state.systems[system - 1])
    state.rotation = state.rotations[system - 1]


G_CODES = table(
    *(
        Code(name=name, about=f"coordinate system {system}", group="coordinate system", step="coordinate system",
             run=_use(system))
        for system, name in enumerate(SYSTEMS, start=1)
    )
)  # fmt: skip
