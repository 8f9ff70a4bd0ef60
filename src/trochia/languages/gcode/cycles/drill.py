"""G73, G81, G82, G83: drilling.  In: a hole at R.  Out: the feeds and rapids in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ParseError
from trochia.languages.gcode.codes import table
from trochia.languages.gcode.cycles.hole import MOST_TIMES, hole_cycle

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.languages.gcode.cycles.hole import Hole

RELIEF = (0.254, 0.01)  #: how far pecking keeps off the bottom it has made [mm], [inch]


def drill(hole: Hole) -> None:
    """G81: feed to the bottom."""
    hole.feed(hole.bottom)
    hole.rapid(hole.back)


def drill_and_wait(hole: Hole) -> None:
    """G82: feed to the bottom, wait P seconds."""
    hole.feed(hole.bottom)
    hole.sink.dwell(hole.words["p"])
    hole.rapid(hole.back)


def peck(hole: Hole) -> None:
    """G83: feed Q at a time; between them leave the hole, and come back to just above its bottom."""
    relief = RELIEF[hole.state.inch]
    for reached in _pecks(hole):
        hole.rapid(hole.clear)
        hole.rapid(reached + relief)


def break_chips(hole: Hole) -> None:
    """G73: feed Q at a time; between them draw back a little."""
    relief = RELIEF[hole.state.inch]
    for reached in _pecks(hole):
        hole.rapid(reached + relief)


def _pecks(hole: Hole) -> Iterator[float]:
    """Feed Q deeper at a time; yield each depth reached but the last, the bottom."""
    step = hole.words["q"]
    if step <= 0:
        raise hole.block.fault(ParseError, f"{hole.name} needs Q above 0", "q", hint="Q is the depth of one peck.")
    if (hole.clear - hole.bottom) / step * hole.block.values.get("l", 1.0) > MOST_TIMES:
        word = "q" if "q" in hole.block.values else hole.block.mover
        raise hole.block.fault(ParseError, f"{hole.name} would peck more than {MOST_TIMES} times", word,
                               hint="Write a greater Q.")  # fmt: skip
    depth = hole.clear - step
    while depth > hole.bottom:
        hole.feed(depth)
        yield depth
        depth -= step
    hole.feed(hole.bottom)
    hole.rapid(hole.back)


G_CODES = table(
    hole_cycle("G73", "drill, breaking chips", break_chips, words="ql", needs="q"),
    hole_cycle("G81", "drill", drill, words="l"),
    hole_cycle("G82", "drill, wait at the bottom", drill_and_wait, words="pl", needs="p"),
    hole_cycle("G83", "drill, leaving the hole between pecks", peck, words="ql", needs="q"),
)
