"""G61, G61.1, G64: how exactly the path is followed.

In: P and Q of G64.  Out: set_motion_control_mode and, with G64, set_naivecam_tolerance.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table
from trochia.program.modes import PathMode

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def exact_path(block: Block, state: State, sink: Sink) -> None:
    """G61: keep to the path."""
    del block
    state.path_mode = PathMode.EXACT_PATH
    sink.set_motion_control_mode(PathMode.EXACT_PATH, 0.0)


def exact_stop(block: Block, state: State, sink: Sink) -> None:
    """G61.1: stop at every end point."""
    del block
    state.path_mode = PathMode.EXACT_STOP
    sink.set_motion_control_mode(PathMode.EXACT_STOP, 0.0)


def blend(block: Block, state: State, sink: Sink) -> None:
    """G64: blend corners within P; drop points within Q, or P where no Q is given.  A negative value counts as none."""
    tolerance = block.values.get("p", -1.0)
    state.path_mode = PathMode.BLEND if tolerance >= 0 else PathMode.BLEND_DEFAULT
    state.tolerance = max(tolerance, 0.0)
    sink.set_motion_control_mode(state.path_mode, state.tolerance)
    along = block.values.get("q", -1.0)
    state.tolerance_along = along if along >= 0 else state.tolerance
    sink.set_naivecam_tolerance(state.tolerance_along)


_GROUP = "path control"
G_CODES = table(
    Code(name="G61", about="exact path", group=_GROUP, step=_GROUP, run=exact_path),
    Code(name="G61.1", about="exact stop", group=_GROUP, step=_GROUP, run=exact_stop),
    Code(name="G64", about="blend corners within P", group=_GROUP, step=_GROUP, run=blend, words="pq"),
)
