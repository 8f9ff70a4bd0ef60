"""G74, G84: tapping with a floating chuck.  In: a hole at R.  Out: feed in, turn the spindle about, feed out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import table
from trochia.languages.gcode.cycles.hole import DWELL, hole_cycle

if TYPE_CHECKING:
    from trochia.languages.gcode.cycles.hole import Hole, Work


def _tap(direction: int) -> Work:
    """Return the work in a hole of a thread cut with the spindle turning +1 clockwise, -1 counter-clockwise."""

    def tap(hole: Hole) -> None:
        hole.need_spindle(direction)
        sink = hole.sink
        sink.feed_override(on=False)
        sink.speed_override(on=False)
        hole.feed(hole.bottom)
        sink.stop_spindle()
        sink.start_spindle(-direction)
        sink.dwell(hole.words[DWELL])
        hole.feed(hole.back)
        sink.stop_spindle()
        sink.start_spindle(direction)
        sink.feed_override(on=True)
        sink.speed_override(on=True)

    return tap


G_CODES = table(
    hole_cycle("G74", "tap a left-hand thread", _tap(-1), words="p"),
    hole_cycle("G84", "tap a right-hand thread", _tap(+1), words="pl"),
)
