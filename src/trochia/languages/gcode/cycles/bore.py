"""G85 to G89: boring.  In: a hole at R.  Out: the moves in it, with what the spindle does.

G87 and G88 are LinuxCNC's: it accepts them, but its controller does not stop the spindle at an angle for G87 nor wait
for a hand retract in G88; ``check`` warns of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.codes import table
from trochia.languages.gcode.cycles.hole import hole_cycle

if TYPE_CHECKING:
    from trochia.languages.gcode.cycles.hole import Hole

_SAME_WAY = {1: 2, -1: 3}  # how the reference says that the spindle turns to its angle the way it runs


def bore(hole: Hole) -> None:
    """G85: feed in, feed out."""
    hole.feed(hole.bottom)
    hole.feed(hole.clear)
    hole.rapid(hole.back)


def bore_and_stop(hole: Hole) -> None:
    """G86: feed in, wait P seconds, stop the spindle, leave by a rapid, start it."""
    hole.need_spindle()
    hole.feed(hole.bottom)
    hole.sink.dwell(hole.words["p"])
    hole.sink.stop_spindle()
    hole.rapid(hole.back)
    hole.sink.start_spindle(hole.state.direction)


def bore_from_behind(hole: Hole) -> None:
    """G87: go through the hole beside its axis with the spindle stopped, bore the far side on the way back."""
    hole.need_spindle()
    state, sink, words = hole.state, hole.sink, hole.words
    sink.unfinished("G87", "the spindle is not turned to the angle at which its tool passes the hole")
    letters = "ijk"
    first, second = (words[letters[axis]] for axis in state.plane.axes)
    back = words[letters[state.plane.normal]]
    beside = {"first": first, "second": second}
    sink.straight_traverse(hole.point(hole.clear, **beside))
    sink.stop_spindle()
    sink.orient_spindle(0.0, _SAME_WAY[state.direction])
    sink.straight_traverse(hole.point(hole.bottom, **beside))
    hole.rapid(hole.bottom)
    sink.start_spindle(state.direction)
    hole.feed(back if state.absolute else hole.bottom + back)
    hole.feed(hole.bottom)
    sink.stop_spindle()
    sink.orient_spindle(0.0, _SAME_WAY[state.direction])
    sink.straight_traverse(hole.point(hole.bottom, **beside))
    sink.straight_traverse(hole.point(hole.back, **beside))
    hole.rapid(hole.back)
    sink.start_spindle(state.direction)


def bore_and_leave_by_hand(hole: Hole) -> None:
    """G88: feed in, wait P seconds, stop the spindle, wait for the operator, start it."""
    hole.need_spindle()
    hole.feed(hole.bottom)
    hole.sink.dwell(hole.words["p"])
    hole.sink.stop_spindle()
    hole.sink.unfinished("G88", "the tool must be taken out of the hole by hand before the program goes on")
    hole.sink.program_stop(optional=False)
    hole.sink.start_spindle(hole.state.direction)


def bore_and_wait(hole: Hole) -> None:
    """G89: feed in, wait P seconds, feed out."""
    hole.feed(hole.bottom)
    hole.sink.dwell(hole.words["p"])
    hole.feed(hole.back)


G_CODES = table(
    hole_cycle("G85", "bore, feed out", bore, words="l"),
    hole_cycle("G86", "bore, stop the spindle, leave", bore_and_stop, words="pl", needs="p"),
    hole_cycle("G87", "bore from behind (moves only)", bore_from_behind, words="ijkl", needs="ijk"),
    hole_cycle("G88", "bore, wait for the operator (moves only)", bore_and_leave_by_hand, words="pl", needs="p"),
    hole_cycle("G89", "bore, wait, feed out", bore_and_wait, words="pl", needs="p"),
)
