"""Plain lines under cutter compensation: rows of the C reader to the stage that moves the tool's centre.

In: a batch of rows.  Out: the calls the interpreter would have made for their lines.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError
from trochia.kernels.gcode import COMMENT_ROW, FEED_ROW, SPEED_ROW
from trochia.languages.gcode.block import sort_words
from trochia.languages.gcode.compensator import GougeError
from trochia.languages.gcode.place import Place
from trochia.languages.gcode.reader import read_line
from trochia.languages.gcode.texts import next_line
from trochia.program.modes import MoveKind

if TYPE_CHECKING:
    from trochia.kernels.gcode import PlainRow, Rows
    from trochia.languages.gcode.compensator import Compensator
    from trochia.languages.gcode.texts import Text
    from trochia.program.modes import Plane

_FEED, _ARC = int(MoveKind.FEED), int(MoveKind.ARC)


def compensate(rows: Rows, stage: Compensator, plane: Plane, text: Text, *, offset: int, line: int) -> None:
    """Hand a batch of rows to the compensation; its first line stands at byte ``offset`` and has number ``line``.

    Raises
    ------
    ModalConflictError
        For a move the tool cannot make.
    """
    try:
        for index, row in enumerate(rows.values()):
            stage.line = row.line
            kind = row.kind
            if kind == _FEED:
                stage.straight_feed(row.target)
            elif kind == _ARC:
                stage.arc_feed(row.target, row.centre, row.turns, plane)
            elif kind < _ARC:
                stage.straight_traverse(row.target)
            else:
                _other(row, index, rows, stage)
    except GougeError as error:
        stage.forget()
        raise _fault(error, text, offset, stage.line - line) from error


def _other(row: PlainRow, index: int, rows: Rows, stage: Compensator) -> None:
    """Hand over a row that is no move."""
    if row.kind == FEED_ROW:
        stage.set_feed_rate(row.rate)
    elif row.kind == SPEED_ROW:
        stage.set_spindle_speed(row.rate)
    elif row.kind == COMMENT_ROW:
        stage.comment(rows.comment(index))


def _fault(error: GougeError, text: Text, offset: int, lines: int) -> ModalConflictError:
    """Return the error of the line that stands some lines below ``offset``."""
    data = text.data
    line = data[:offset].count(b"\n") + lines + 1
    for _ in range(lines):
        _, offset = next_line(data, offset)
    block = sort_words(read_line(Place(text.name, line, next_line(data, offset)[0])), "xyzabcuvw")
    block.motion = block.groups.get("motion")
    return block.fault(ModalConflictError, error.message, block.mover, hint=error.hint)
