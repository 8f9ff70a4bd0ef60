"""F, G93, G94, G95: the feed and what it is measured in.  Out: set_feed_mode, set_feed_rate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, Handler, WordCode, table
from trochia.languages.gcode.groups.spindle import check_spindle
from trochia.program.modes import TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def set_feed(block: Block, state: State, sink: Sink) -> None:
    """F: the feed; in inverse time it belongs to its own move and is set there."""
    if state.law == TimeLaw.INVERSE:
        return
    state.feed = block.values["f"]
    sink.set_feed_rate(state.feed)


def _use(law: TimeLaw, name: str) -> Handler:
    def use(block: Block, state: State, sink: Sink) -> None:
        if law == TimeLaw.PER_REV:
            check_spindle(block, one=True)
        state.law = law
        sink.comment(f"interpreter: feed mode set to {name}")
        sink.set_feed_mode(law)
        if law != TimeLaw.INVERSE:  # the old number would mean something else
            state.feed = 0.0
            sink.set_feed_rate(0.0)

    return use


F = WordCode(letter="f", about="feed", step="feed", run=set_feed)

_GROUP = "feed mode"
G_CODES = table(
    Code(name="G93", about="F is moves per minute", group=_GROUP, step=_GROUP,
         run=_use(TimeLaw.INVERSE, "inverse time")),
    Code(name="G94", about="F is units per minute", group=_GROUP, step=_GROUP,
         run=_use(TimeLaw.PER_SECOND, "units per minute")),
    Code(name="G95", about="F is units per revolution", group=_GROUP, step=_GROUP,
         run=_use(TimeLaw.PER_REV, "units per revolution"), words="$"),
)  # fmt: skip
