"""S, G96, G97, M3, M4, M5, M19: spindle or beam.

In: S, D (greatest speed), $ (which spindle; there is one, 0, and -1 means all), R, P, Q of M19.  Out:
set_spindle_speed, set_spindle_mode, start_spindle, stop_spindle, orient_spindle, wait_orient.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ParseError
from trochia.languages.gcode.codes import Code, Handler, WordCode, table
from trochia.languages.gcode.numbers import as_integer

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

_ALL = -1
_TURN = 360.0
_WAYS = 2


def set_speed(block: Block, state: State, sink: Sink) -> None:
    """S: speed of the spindle, or power of the beam."""
    check_spindle(block)
    state.speed = block.values["s"]
    sink.set_spindle_speed(state.speed)


def constant_speed(block: Block, state: State, sink: Sink) -> None:
    """G97: S is the speed itself, as it is from the beginning."""
    check_spindle(block)
    state.surface_speed, state.most_speed = False, None
    sink.set_spindle_mode(None, on=False)


def surface_speed(block: Block, state: State, sink: Sink) -> None:
    """G96: S is the speed of the cut; the spindle turns at D at most."""
    check_spindle(block)
    if "s" not in block.values:
        raise block.fault(ParseError, "G96 needs the speed of the cut as S on its line", "G96",
                          hint="Write it like G96 S120 D2500, in m/min (G20: ft/min).")  # fmt: skip
    state.surface_speed = True
    state.most_speed = abs(block.values["d"]) if "d" in block.values else None
    sink.set_spindle_mode(state.most_speed, on=True)


def check_spindle(block: Block, *, one: bool = False) -> None:
    """Check that ``$`` names the spindle that is there, or all (-1) where not exactly ``one`` is wanted.

    Raises
    ------
    ParseError
        For another one.
    """
    number = int(block.values.get("$", 0.0))
    if number != 0 and (one or number != _ALL):
        raise block.fault(ParseError, f"there is no spindle ${number}", "$", hint="There is one spindle, $0.")


def _start(direction: int) -> Handler:
    def start(block: Block, state: State, sink: Sink) -> None:
        check_spindle(block)
        state.direction = direction
        sink.start_spindle(direction)

    return start


def stop(block: Block, state: State, sink: Sink) -> None:
    """M5: stop the spindle, put the beam out."""
    check_spindle(block)
    state.direction = 0
    sink.stop_spindle()


def orient(block: Block, state: State, sink: Sink) -> None:
    """M19: turn the spindle to angle R and hold it; with Q wait for it, Q seconds at most."""
    check_spindle(block)
    angle, way = block.values.get("r"), as_integer(block.values.get("p", 0.0))
    if angle is not None and not 0 <= angle <= _TURN:
        raise block.fault(ParseError, "R of M19 is an angle from 0 to 360", "r",
                          hint="Add or take away whole turns.")  # fmt: skip
    if way is None or not 0 <= way <= _WAYS:
        raise block.fault(ParseError, "P of M19 is 0 (shorter way), 1 (clockwise) or 2 (counter-clockwise)", "p",
                          hint="Leave P out for the shorter way.")  # fmt: skip
    if angle is not None or "p" in block.values:
        state.direction = 0
        sink.orient_spindle(angle or 0.0, way)
    if "q" in block.values:
        if block.values["q"] <= 0:
            raise block.fault(ParseError, "Q of M19 is the longest time to wait, above zero", "q",
                              hint="Leave Q out to go on without waiting.")  # fmt: skip
        sink.wait_orient(block.values["q"])


S = WordCode(letter="s", about="spindle speed or beam power", step="speed", run=set_speed)

G_CODES = table(
    Code(name="G96", about="S is the speed of the cut", group="spindle mode", step="spindle mode",
         run=surface_speed, words="d"),
    Code(name="G97", about="S is the speed", group="spindle mode", step="spindle mode", run=constant_speed),
)  # fmt: skip
M_CODES = table(
    Code(name="M3", about="spindle clockwise, beam on", group="spindle", step="spindle", run=_start(+1), words="$"),
    Code(name="M4", about="spindle counter-clockwise", group="spindle", step="spindle", run=_start(-1), words="$"),
    Code(name="M5", about="spindle or beam off", group="spindle", step="spindle", run=stop, words="$"),
    Code(name="M19", about="turn the spindle to angle R", group="spindle", step="spindle", run=orient, words="rpq$"),
)
