"""G76: cut a thread in passes.  In: the thread's end and shape.  Out: rapids and moves locked to the spindle.

The tool stands on the *drive line*, parallel to Z.  I leads from it to the thread's crest, J is the depth of the first
pass, K that of the thread.  Pass n is J n^(1/R) deep, the last one K, and H more follow at K.  Each pass begins the
less high, and with Q (the angle of the compound slide) the farther along Z, the deeper it is.  E is the length of the
taper at the beginning (L1), the end (L2), or both (L3); along it the pitch counts along the slope.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import copysign, hypot, log, radians, tan
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, table
from trochia.languages.gcode.groups.motion import target_of
from trochia.languages.gcode.groups.synchronised import require_spindle
from trochia.program.modes import AXES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_X, _Z = 0, 2
_ENTRY, _EXIT = (1, 3), (2, 3)  # values of L
_REACHED = 1e-12  # a pass this close to the depth of the thread is the last one
_STEEPEST = 90.0  # degree: at this angle of the slide there is no thread
_MOST_PASSES = 10_000  # of one line, where the reference has no bound


@dataclass(frozen=True, slots=True, kw_only=True)
class Thread:
    """A thread, lengths in program units along X as radii.

    ``outward`` is +1 where the tool is in a bore and cuts towards greater X; ``along`` the sign of Z.
    """

    start: list[float]
    end_z: float
    pitch: float
    offset: float
    first_depth: float
    depth: float
    degression: float
    slope: float
    springs: int
    entry: float
    exit: float

    @property
    def outward(self) -> float:
        """Return the direction of cutting along X."""
        return copysign(1.0, self.offset)

    @property
    def along(self) -> float:
        """Return the direction of cutting along Z."""
        return -1.0 if self.end_z <= self.start[_Z] else 1.0

    @property
    def tapered_pitch(self) -> float:
        """Return the pitch along the taper."""
        length = self.entry or self.exit
        return self.pitch * hypot(length, self.depth) / length

    def depths(self) -> Iterator[float]:
        """Yield the depth of each pass."""
        n, depth = 1, self.first_depth
        while depth < self.depth - _REACHED:
            yield depth
            n += 1
            depth = self.first_depth * n ** (1.0 / self.degression)
        for _ in range(1 + self.springs):
            yield self.depth


def cut(block: Block, state: State, sink: Sink) -> None:
    """G76: cut the thread; it ends on the drive line at the thread's end."""
    require_spindle(block, state, "G76")
    end = target_of(block, state)
    thread = _thread(block, state, end)
    for depth in thread.depths():
        _pass(thread, depth, sink)
    sink.straight_traverse(end)
    state.position = end
    state.motion = 760


def _pass(thread: Thread, depth: float, sink: Sink) -> None:
    """Send one pass: out to its height, in, along, out."""
    rest = thread.depth - depth
    shift = thread.along * thread.slope
    safe = thread.start[_X] - thread.outward * rest
    floor = safe + thread.offset + thread.outward * thread.depth
    start_z, end_z = thread.start[_Z] + shift * depth, thread.end_z - shift * rest
    crest = floor - thread.outward * thread.depth

    def point(x: float, z: float) -> list[float]:
        there = thread.start.copy()
        there[_X], there[_Z] = x, z
        return there

    sink.straight_traverse(point(safe, start_z))
    if not thread.entry:
        sink.straight_traverse(point(floor, start_z))
    sink.feed_override(on=False)
    if thread.entry:
        sink.start_synchronised(thread.tapered_pitch)
        sink.straight_feed(point(crest, start_z))
        sink.straight_feed(point(floor, start_z + thread.along * thread.entry))
    sink.start_synchronised(thread.pitch)
    sink.straight_feed(point(floor, end_z - thread.along * thread.exit))
    if thread.exit:
        sink.start_synchronised(thread.tapered_pitch)
        sink.straight_feed(point(crest, end_z))
    sink.stop_synchronised()
    sink.straight_traverse(point(safe, end_z))
    sink.feed_override(on=True)


def _thread(block: Block, state: State, end: list[float]) -> Thread:
    """Return the thread of the line's words.

    Raises
    ------
    ParseError, ModalConflictError
        For a shape that cannot be.
    """
    value = block.values
    for column in block.axes:
        if AXES[column] in "ABC":
            letter = AXES[column]
            raise block.fault(ParseError, f"G76 cannot move {letter}", letter.lower(), hint="Move it before the cycle.")
    if value["i"] == 0.0:
        raise block.fault(ParseError, "I of G76 must not be 0", "i", hint="I leads from the drive line to the crest.")
    if value["j"] <= 0.0:
        raise block.fault(ParseError, "J of G76 must be above 0", "j", hint="J is the depth of the first pass.")
    if value["k"] <= value["j"]:
        raise block.fault(ModalConflictError, "K of G76 must be greater than J", "k",
                          hint="K is the depth of the thread, J that of the first pass.")  # fmt: skip
    if abs(value.get("q", 0.0)) >= _STEEPEST:
        raise block.fault(ParseError, "Q of G76 must be below 90 degrees", "q", hint="Q29.5 is usual.")
    _require_few_passes(block)
    scale = 0.5 if state.diameter else 1.0
    taper, where = max(value.get("e", 0.0), 0.0), round(value.get("l", 0.0))
    return Thread(
        start=state.position,
        end_z=end[_Z],
        pitch=value["p"],
        offset=scale * value["i"],
        first_depth=scale * value["j"],
        depth=scale * value["k"],
        degression=max(value.get("r", 1.0), 1.0),
        slope=tan(radians(value.get("q", 0.0))),
        springs=max(round(value.get("h", 0.0)), 0),
        entry=taper if where in _ENTRY else 0.0,
        exit=taper if where in _EXIT else 0.0,
    )


def _require_few_passes(block: Block) -> None:
    """Refuse a thread of so many passes that it would never end: from pass to pass R and J lead to K, then H more."""
    value = block.values
    passes = max(value.get("r", 1.0), 1.0) * log(value["k"] / value["j"])  # logarithm of their number
    if passes > log(_MOST_PASSES) or value.get("h", 0.0) > _MOST_PASSES:
        raise block.fault(ParseError, f"G76 would take more than {_MOST_PASSES} passes", block.mover,
                          hint="Write a greater J, or a smaller R or H.")  # fmt: skip


def _check(block: Block, state: State) -> None:
    """Check the words before anything acts."""
    del state
    if not block.has_target:
        raise block.fault(ParseError, "G76 has no axis word", "G76", hint="Write where the thread ends: Z.")
    for letter, what in (("p", "the pitch"), ("i", "the way from the drive line to the crest"),
                         ("j", "the depth of the first pass"), ("k", "the depth of the thread")):  # fmt: skip
        if letter not in block.values or (letter == "p" and block.values["p"] == -1.0):
            raise block.fault(ParseError, f"G76 needs {letter.upper()}", block.mover,
                              hint=f"{letter.upper()} is {what}.")  # fmt: skip


G_CODES = table(
    Code(name="G76", about="cut a thread in passes", group="motion", step="motion", run=cut, words="pijkqhelr$",
         check=_check),
)  # fmt: skip
