"""M0, M1, M2, M30: stop and end.  Out: program_stop, program_end and what the end resets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, table
from trochia.languages.gcode.groups.coordinates import activate
from trochia.program.modes import Plane, TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def _stop(*, optional: bool) -> Handler:
    def stop(block: Block, state: State, sink: Sink) -> None:
        del block, state
        sink.program_stop(optional=optional)

    return stop


def pallet(block: Block, state: State, sink: Sink) -> None:
    """M60: change pallets and wait for the operator."""
    del block, state
    sink.pallet_shuttle()
    sink.program_stop(optional=False)


def _end(*, pallet: bool) -> Handler:
    def end(block: Block, state: State, sink: Sink) -> None:
        del block
        _reset(state, sink)
        if pallet:
            sink.pallet_shuttle()
        sink.program_end()
        state.ended = True

    return end


def _reset(state: State, sink: Sink) -> None:
    """Go back to G54, G17, G94, F0; spindle and coolant off."""
    activate(state, 1)
    sink.set_g5x_offset(1, state.origin)
    sink.set_xy_rotation(state.rotation)
    if state.plane != Plane.XY:
        sink.select_plane(Plane.XY)
    sink.set_feed_mode(TimeLaw.PER_SECOND)
    sink.set_feed_rate(0.0)
    if not state.feed_override:  # the other overrides stay as they are, as in the reference
        sink.feed_override(on=True)
    sink.stop_spindle()
    sink.set_spindle_mode(None, on=False)
    if state.mist:
        sink.mist(on=False)
    if state.flood:
        sink.flood(on=False)


M_CODES = table(
    Code(name="M0", about="stop", group="stopping", step="stop", run=_stop(optional=False)),
    Code(name="M1", about="stop, if the operator wants", group="stopping", step="stop", run=_stop(optional=True)),
    Code(name="M2", about="end of program", group="stopping", step="stop", run=_end(pallet=False)),
    Code(name="M60", about="change pallet, stop", group="stopping", step="stop", run=pallet),
    Code(name="M30", about="end of program, change pallet", group="stopping", step="stop", run=_end(pallet=True)),
)
