"""A checked line acts: its parts in the order of execution, whatever their place on the line.

In: a checked :class:`~trochia.languages.gcode.block.Block`.  Out: a changed state, and calls to the sink.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.languages.gcode.block import sort_words
from trochia.languages.gcode.check import check
from trochia.languages.gcode.codes import key_of
from trochia.languages.gcode.comments import act
from trochia.languages.gcode.groups.compensation import run_compensated, sink_of
from trochia.languages.gcode.place import Place
from trochia.languages.gcode.reader import read_line
from trochia.languages.gcode.registry import RANK
from trochia.languages.gcode.state import NO_MOTION

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.codes import Code, WordCode
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_PASSING = ("G70", "G71", "G72")  # motion codes that are not in force on the next line
_FEED = 10  # G1 in tenths


def execute(block: Block, state: State, sink: Sink) -> None:
    """Let the parts of a checked line act in the order of execution."""
    if block.comment is not None:
        act(block.comment, block.place, state, sink_of(state, sink))
    parts: list[tuple[int, Code | WordCode]] = [(RANK[code.step], code) for code in block.codes]
    parts += [(RANK[word.step], word) for word in block.acting]
    if block.motion is not None and "motion" not in block.groups:
        parts.append((RANK["motion"], block.motion))
    if len(parts) > 1:
        parts.sort(key=_rank)
    for _, part in parts:
        if state.compensation is None:
            part.run(block, state, sink)
        else:
            run_compensated(part, block, state, sink)
        if block.dropped:
            return


def _rank(part: tuple[int, Code | WordCode]) -> int:
    return part[0]


def run_line(line: str, place: Place, state: State, sink: Sink) -> None:
    """Run a line that is not in the text; errors are those of a line, with the place of ``place``."""
    there = Place(place.file, place.line, line.encode("latin-1", errors="replace"))
    block = sort_words(read_line(there, state.parameters), "xyzabcuvw")
    check(block, state)
    execute(block, state, sink)


def pretend_done(block: Block | None, state: State) -> None:
    """After an error, go on as if the line had been right, so that one mistake is not reported on every line."""
    if block is None:
        return
    if state.absolute:
        for axis, value in block.axes.items():
            state.position[axis] = value
    if block.is_polar:
        state.position[0] = state.position[0] or 1.0  # the origin has no angle
    if "motion" in block.groups and block.motion is not None:
        name = block.motion.name
        state.motion = _FEED if name.startswith(_PASSING) else key_of(float(name[1:]))
    elif block.has_target and state.motion == NO_MOTION:
        state.motion = 0
    for word in ("r", "depth", "initial"):  # a cycle that was refused may lack what its next line takes from it
        state.cycle_words.setdefault(word, state.position[state.plane.normal])
    state.feed = state.feed or 1.0
    state.speed = state.speed or 1.0
