"""G33, G33.1: moves locked to the spindle.  In: axis words, K the way per turn.  Out: straight_feed, rigid_tap.

No F counts: the spindle's speed and K give the feed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.groups.motion import target_of
from trochia.languages.gcode.groups.spindle import check_spindle

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def thread(block: Block, state: State, sink: Sink) -> None:
    """G33: go straight, K along the way for each turn of the spindle."""
    require_spindle(block, state, "G33")
    end = target_of(block, state)
    sink.start_synchronised(block.values["k"])
    sink.straight_feed(end)
    sink.stop_synchronised()
    state.position = end
    state.motion = 330


def rigid_tap(block: Block, state: State, sink: Sink) -> None:
    """G33.1: go in locked to the spindle, turn it about, come back the same way; I times as fast."""
    require_spindle(block, state, "G33.1")
    end = target_of(block, state)
    sink.start_synchronised(block.values["k"])
    sink.rigid_tap(state.position, end, block.values.get("i", 1.0))
    sink.stop_synchronised()
    state.motion = 331


def require_spindle(block: Block, state: State, name: str) -> None:
    """Check that the spindle turns.

    Raises
    ------
    ModalConflictError
        If it does not.
    ParseError
        For a ``$`` that names another one.
    """
    check_spindle(block, one=True)
    if not state.direction:
        raise block.fault(ModalConflictError, f"{name} needs a turning spindle", block.mover,
                          hint="Write S, and M3 or M4, before it.")  # fmt: skip


def _check(block: Block, state: State) -> None:
    """Check the words before anything acts."""
    del state
    assert block.motion is not None
    name = block.motion.name
    if not block.has_target:
        raise block.fault(ParseError, f"{name} has no axis word", name, hint="Write where it ends, like Z-10.")
    if "k" not in block.values:
        raise block.fault(ParseError, f"{name} needs K on every line", block.mover, hint="K is the way for each turn.")
    if "f" in block.values:
        raise block.fault(ParseError, f"{name} takes no F", "f", hint="Its feed is K for each turn of the spindle.")


G_CODES = table(
    Code(name="G33", about="move locked to the spindle", group="motion", step="motion", run=thread, words="ke$",
         check=_check),
    Code(name="G33.1", about="rigid tapping", group="motion", step="motion", run=rigid_tap, words="kie$", check=_check),
)  # fmt: skip
