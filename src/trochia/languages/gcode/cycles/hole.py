"""What all hole cycles share: sticky words, levels, positioning, repeats.

In: the hole in the plane's axes, its depth and R along the normal, L repeats.  Out: the moves to each hole; what
happens in it is the cycle's own.

Levels along the normal: *initial* is where the first of a row of cycles began, *clear* is R, *bottom* the depth.  In
incremental mode R is measured from the initial level, the depth from R.  *back* is the level a cycle ends at: R, or the
initial level with G98.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, key_of
from trochia.languages.gcode.polar import polar_point, polar_step
from trochia.program.modes import AXES, PathMode, TimeLaw

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

    Work = Callable[["Hole"], None]

#: modal motions that are hole cycles, in tenths; a row of them has one initial level
HOLE_CYCLES = frozenset(10 * number for number in (73, 74, *range(81, 90)))
_LINEAR = 3  # columns before this one are X, Y, Z
_INITIAL = "initial"
_NONE = -1.0  # a Q of this value counts as none
MOST_TIMES = 10_000  #: holes and pecks of one line, where the reference has no bound
DWELL = "dwell"  #: the last P of any cycle, which tapping cycles take when they have none


@dataclass(slots=True, kw_only=True)
class Hole:
    """One hole, and the means to move in it.

    Attributes
    ----------
    block, state, sink
        The line, the modal state, the receiver.
    name
        The cycle as written, ``G81``.
    clear, bottom, back
        Levels along the normal: R, the depth, and where the cycle ends.
    first, second
        The hole's place on the plane's axes.
    words
        Words in force for the cycle, by letter; they stay until another cycle.
    """

    block: Block
    state: State
    sink: Sink
    name: str
    clear: float
    bottom: float
    back: float
    first: float = 0.0
    second: float = 0.0
    words: dict[str, float]

    def point(self, level: float, *, first: float = 0.0, second: float = 0.0) -> list[float]:
        """Return the point at a level of the hole, shifted on the plane's axes."""
        plane = self.state.plane
        end = self.state.position.copy()
        end[plane.axes[0]], end[plane.axes[1]] = self.first + first, self.second + second
        end[plane.normal] = level
        return end

    def rapid(self, level: float) -> None:
        """Go to a level as fast as the axis can."""
        self.sink.straight_traverse(self.point(level))

    def feed(self, level: float) -> None:
        """Go to a level at the feed."""
        self.sink.straight_feed(self.point(level))

    def need_spindle(self, direction: int = 0) -> None:
        """Check that the spindle turns, and that way [+1 clockwise, -1 counter-clockwise, 0 either].

        Raises
        ------
        ModalConflictError
            If it does not.
        """
        turns = self.state.direction
        if not turns:
            raise self.block.fault(ModalConflictError, f"{self.name} needs a turning spindle", self.block.mover,
                                   hint=f"Write {'M4' if direction < 0 else 'M3'} before it.")  # fmt: skip
        if direction and turns != direction:
            ways = {1: "clockwise", -1: "counter-clockwise"}
            raise self.block.fault(ModalConflictError, f"{self.name} needs the spindle to turn {ways[direction]}",
                                   self.block.mover, hint="Write M3." if direction > 0 else "Write M4.")  # fmt: skip


def hole_cycle(name: str, about: str, work: Work, *, words: str = "", needs: str = "") -> Code:
    """Return the row of a hole cycle.

    Parameters
    ----------
    work
        What happens in the hole, from R on.
    words
        Letters it reads beside R.
    needs
        Those of them that must be there, when the cycle begins.
    """

    def run(block: Block, state: State, sink: Sink) -> None:
        _drill_row(name, block, state, sink, work=work, needs=needs)

    return Code(name=name, about=about, group="motion", step="motion", run=run, words="r" + words, check=_check)


def _check(block: Block, state: State) -> None:
    """Check the axis words before anything acts."""
    del state
    name = "" if block.motion is None else block.motion.name
    if not block.has_target:
        raise block.fault(ParseError, f"{name} has no axis word", name, hint="Write where the hole is, like X10.")
    for column in block.axes:
        if column >= _LINEAR:
            letter = AXES[column]
            raise block.fault(ParseError, f"a canned cycle cannot move {letter}", letter.lower(),
                              hint=f"Move {letter} on a line of its own.")  # fmt: skip


def _drill_row(name: str, block: Block, state: State, sink: Sink, *, work: Work, needs: str) -> None:
    """Position over each hole of the line, do its work, go back."""
    _open_row(name, block, state)
    repeats = _repeats(block)
    _require_feed(block, state)
    hole = _hole(name, block, state, sink)
    normal = state.plane.normal
    if state.cycle_words[_INITIAL] < hole.clear:  # too low to travel: rise first
        lifted = state.position.copy()
        lifted[normal] = hole.clear
        sink.straight_traverse(lifted)
        state.position = lifted
    exact = state.path_mode == PathMode.EXACT_PATH
    if not exact:
        sink.begin_exact_path()
    _require_words(name, block, hole.words, needs)
    for _ in range(repeats):
        _position(hole)
        work(hole)
        state.position = hole.point(hole.back)
    if not exact:
        sink.end_exact_path(state.path_mode, state.tolerance, state.tolerance_along)
    state.motion = key_of(float(name[1:]))


def _open_row(name: str, block: Block, state: State) -> None:
    """Take the line's words into those in force."""
    held = state.cycle_words
    if state.motion not in HOLE_CYCLES:
        held[_INITIAL] = state.position[state.plane.normal]
    normal = AXES[state.plane.normal].lower()
    if state.motion != key_of(float(name[1:])):
        for letter in "rpqijk":
            held.pop(letter, None)
        if "r" not in block.values:
            raise block.fault(ParseError, f"{name} needs R", name, hint="R is the level at which feeding begins.")
        if normal not in block.values:
            raise block.fault(ParseError, f"{name} needs {normal.upper()}", name,
                              hint=f"{normal.upper()} is the depth of the hole.")  # fmt: skip
    for letter in "rpqijk":
        if letter in block.values:
            held[letter] = block.values[letter]
    held[DWELL] = held.get("p", held.get(DWELL, 0.0))
    if normal in block.values:
        held["depth"] = block.values[normal]


def _repeats(block: Block) -> int:
    repeats = round(block.values.get("l", 1.0))
    if repeats == 0:
        raise block.fault(ParseError, "a cycle cannot be repeated 0 times", "l", hint="Leave L out, or write L1.")
    if repeats > MOST_TIMES:
        raise block.fault(ParseError, f"a line may repeat a cycle at most {MOST_TIMES} times", "l",
                          hint="Write it on more lines, or in a loop.")  # fmt: skip
    return repeats


def _require_feed(block: Block, state: State) -> None:
    if state.law == TimeLaw.INVERSE:
        raise block.fault(ModalConflictError, "a canned cycle cannot use inverse time (G93)", block.mover,
                          hint="Write G94 before it, and F.")  # fmt: skip
    if state.feed == 0.0:
        raise block.fault(ModalConflictError, "this cycle has no feed", block.mover,
                          hint="Write F, like F100, on this line or before it.")  # fmt: skip


def _hole(name: str, block: Block, state: State, sink: Sink) -> Hole:
    """Return the first hole before its increment, its levels checked."""
    held, (first, second) = state.cycle_words, state.plane.axes
    clear, bottom = held["r"], held["depth"]
    if not state.absolute:
        clear += held[_INITIAL]
        bottom += clear
    if clear < bottom:
        raise block.fault(ModalConflictError, f"R {clear:g} lies below the bottom of the hole, {bottom:g}",
                          "r" if "r" in block.values else block.mover,
                          hint=f"R must be at least {bottom:g}.")  # fmt: skip
    back = clear if state.retract_to_r else max(clear, held[_INITIAL])
    hole = Hole(block=block, state=state, sink=sink, name=name, clear=clear, bottom=bottom, back=back, words=held)
    hole.first, hole.second = state.position[first], state.position[second]
    if state.absolute:
        hole.first, hole.second = block.axes.get(first, hole.first), block.axes.get(second, hole.second)
        if block.is_polar:
            hole.first, hole.second = polar_point(block, (hole.first, hole.second))
    return hole


def _require_words(name: str, block: Block, held: dict[str, float], needs: str) -> None:
    """Check that the words a cycle needs are in force, and that a wait is none of negative time."""
    for letter in needs:
        if letter not in held or (letter == "q" and held["q"] == _NONE):
            raise block.fault(ParseError, f"{name} needs {letter.upper()}", block.mover,
                              hint=f"Write {letter.upper()} on the line on which the cycle begins.")  # fmt: skip
    if held.get("p", 0.0) < 0:
        raise block.fault(ParseError, "a wait cannot be negative", "p", hint="P is a time in seconds, 0 or more.")


def _position(hole: Hole) -> None:
    """Go over the next hole, then down to R."""
    state, (first, second) = hole.state, hole.state.plane.axes
    if not state.absolute:
        hole.first += hole.block.axes.get(first, 0.0)
        hole.second += hole.block.axes.get(second, 0.0)
        if hole.block.is_polar:
            hole.first, hole.second = polar_step(hole.block, (hole.first, hole.second), nothing_stays=True)
    here = state.position[state.plane.normal]
    level = here if here > hole.clear else hole.back
    state.position = hole.point(level)
    hole.rapid(level)
    if level != hole.clear:
        hole.rapid(hole.clear)
