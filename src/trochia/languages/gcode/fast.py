"""The plain lines of a program, in C: blanks, comments, G0 to G3 with axes, I J K R, F, S.

In: the text, where to start, and the modal state.  Out: batches of rows to the sink, and the state moved on.  A line
that is not certainly plain and certainly free of error is left to the interpreter, untouched; what is taken gives the
sink exactly what the interpreter would have given it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.kernels.gcode import OTHER_MOTION, STOP_FULL, PlainReader
from trochia.languages.gcode.compensated_rows import compensate
from trochia.languages.gcode.groups.arcs import SHORT_RADIUS, SPIRAL, SPIRAL_MOST, SPIRAL_SHARE
from trochia.program.modes import AXES, TimeLaw

if TYPE_CHECKING:
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State
    from trochia.languages.gcode.texts import Text

_PLAIN_MOTIONS = {0: 0, 10: 1, 20: 2, 30: 3}  # code in tenths -> what the reader calls it


class FastPath:
    """Takes the plain lines of one text.

    Parameters
    ----------
    text
        The text.
    axes
        Letters that are axis words, in lower case.
    compensated
        Take lines under cutter compensation too.  An error there ends the run: who wants to go on after it does not
        want this.
    """

    __slots__ = ("_compensated", "_reader", "_text")

    def __init__(self, text: Text, axes: str, *, compensated: bool) -> None:
        self._text = text
        self._compensated = compensated
        self._reader = PlainReader(text.data)
        self._reader.modal.axes = sum(1 << AXES.index(letter) for letter in axes.upper())

    def advance(self, state: State, sink: Sink, offset: int, line: int) -> tuple[int, int]:
        """Take plain lines from byte ``offset`` on, where line number ``line`` begins; return both as they are now."""
        if state.law is not TimeLaw.PER_SECOND or state.diameter:
            return offset, line
        stage = state.compensation
        if state.straight_next or (stage is not None and not self._compensated):
            return offset, line
        modal = self._reader.modal
        modal.offset, modal.line = offset, line
        self._load(state)
        while True:
            begin = modal.offset, modal.line
            rows = self._reader.read()
            if stage is not None:
                compensate(rows, stage, state.plane, self._text, offset=begin[0], line=begin[1])
            elif len(rows):
                sink.moves(rows)
            if modal.stop != STOP_FULL:
                break
        if modal.offset != offset:
            self._store(state)
            sink.line = modal.line - 1
        return modal.offset, modal.line

    def _load(self, state: State) -> None:
        """Set the reader's modes from the state."""
        modal = self._reader.modal
        modal.position = state.position
        modal.feed = state.feed
        modal.speed = state.speed
        modal.motion = _PLAIN_MOTIONS.get(state.motion, OTHER_MOTION)
        modal.plane = state.plane
        modal.incremental = not state.absolute
        modal.centre_absolute = state.arc_absolute
        modal.least_radius = SHORT_RADIUS[state.inch]
        modal.spiral = SPIRAL[state.inch]
        modal.spiral_most = SPIRAL_MOST[state.inch]
        modal.spiral_share = SPIRAL_SHARE

    def _store(self, state: State) -> None:
        """Set the state from what the lines taken have changed."""
        modal = self._reader.modal
        state.position = list(modal.position)
        state.feed = modal.feed
        state.speed = modal.speed
        if modal.motion != OTHER_MOTION:
            state.motion = 10 * modal.motion
