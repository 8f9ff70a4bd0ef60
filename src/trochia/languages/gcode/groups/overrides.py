"""M48 to M53: whether the operator, or the machine, may change the speed.

In: P (0: not), $ (spindle).  Out: feed_override, speed_override, adaptive_feed, feed_hold.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import Code, table

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State


def all_on(block: Block, state: State, sink: Sink) -> None:
    """M48: both overrides act."""
    del block
    _both(state, sink, on=True)


def all_off(block: Block, state: State, sink: Sink) -> None:
    """M49: neither override acts."""
    del block
    _both(state, sink, on=False)


def _both(state: State, sink: Sink, *, on: bool) -> None:
    state.feed_override = state.speed_override = on
    sink.feed_override(on=on)
    sink.speed_override(on=on)


def feed(block: Block, state: State, sink: Sink) -> None:
    """M50: the feed's override."""
    state.feed_override = _asked(block)
    sink.feed_override(on=state.feed_override)


def speed(block: Block, state: State, sink: Sink) -> None:
    """M51: the spindle's override."""
    state.speed_override = _asked(block)
    sink.speed_override(on=state.speed_override)


def adaptive(block: Block, state: State, sink: Sink) -> None:
    """M52: the feed follows a signal of the machine."""
    state.adaptive_feed = _asked(block)
    sink.adaptive_feed(on=state.adaptive_feed)


def hold(block: Block, state: State, sink: Sink) -> None:
    """M53: the feed-hold switch."""
    state.feed_hold = _asked(block)
    sink.feed_hold(on=state.feed_hold)


def _asked(block: Block) -> bool:
    """Return whether the line switches on: P is not zero, or not there."""
    return block.values.get("p", 1.0) != 0


_GROUP = "override"
M_CODES = table(
    Code(name="M48", about="overrides act", group=_GROUP, step=_GROUP, run=all_on),
    Code(name="M49", about="overrides do not act", group=_GROUP, step=_GROUP, run=all_off),
    Code(name="M50", about="feed override acts, P0: not", group=_GROUP, step=_GROUP, run=feed, words="p"),
    Code(name="M51", about="speed override acts, P0: not", group=_GROUP, step=_GROUP, run=speed, words="p"),
    Code(name="M52", about="adaptive feed acts, P0: not", group=_GROUP, step=_GROUP, run=adaptive, words="p"),
    Code(name="M53", about="feed hold acts, P0: not", group=_GROUP, step=_GROUP, run=hold, words="p"),
)
