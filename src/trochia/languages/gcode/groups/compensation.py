"""G40 G41 G42 G41.1 G42.1: cutter radius compensation.

In: D, the tool whose radius counts, or its diameter (.1), and L, the orientation of a lathe tool.  Out: the comment
the reference prints; from then on :class:`~trochia.languages.gcode.compensator.Compensator` moves the tool's centre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.codes import Code, Handler, WordCode, table
from trochia.languages.gcode.compensator import Compensator, GougeError
from trochia.languages.gcode.groups.tool import slot_of
from trochia.languages.gcode.numbers import as_integer
from trochia.program.modes import Plane

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State

#: Codes that cannot act while cutter compensation is on.
NOT_NOW = frozenset({
    "G5", "G5.1", "G5.2", "G5.3", "G28", "G28.1", "G30", "G30.1", "G33", "G33.1", "G38.2", "G38.3", "G38.4", "G38.5",
    "G43", "G43.1", "G43.2", "G49", "G52", "G53", "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3",
    "G61", "G61.1", "G64", "G73", "G74", "G76", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89", "G92",
    "G98", "G99", "M6", "M48", "M49", "M50", "M51", "M52", "M53", "M62", "M63", "M64", "M65", "M66", "M67", "M68",
})  # fmt: skip
MOST_ORIENTATION = 9
PLANE_CODES = {"G17": Plane.XY, "G18": Plane.ZX, "G19": Plane.YZ}


def off(block: Block, state: State, sink: Sink) -> None:
    """G40: no cutter radius compensation; the next move leads from the tool's centre to its programmed end."""
    del block
    if state.compensation is not None:
        state.compensation.settle()
        state.straight_next = state.compensation.radius > 0
        state.compensation = None
    sink.comment("interpreter: cutter radius compensation off")


def _on(name: str, side: int, given: Callable[[Block, State, str], tuple[float, int]]) -> Handler:
    def on(block: Block, state: State, sink: Sink) -> None:
        if state.plane == Plane.YZ:
            raise block.fault(ModalConflictError, "cutter compensation works in the XY and the ZX plane", name,
                              hint="Select G17 or G18 before it.")  # fmt: skip
        if state.compensation is not None:
            raise block.fault(ModalConflictError, "cutter compensation is on already", name,
                              hint="Switch it off before, by G40 and a straight move.")  # fmt: skip
        diameter, orientation = given(block, state, name)
        if orientation and state.plane != Plane.ZX:
            raise block.fault(ModalConflictError, "a lathe tool's orientation needs the ZX plane",
                              "l" if "l" in block.values and name.endswith(".1") else name,
                              hint="Select G18, or a tool without orientation.")  # fmt: skip
        actual = side if diameter >= 0 else -side
        sink.comment(f"interpreter: cutter radius compensation on {'left' if actual > 0 else 'right'}")
        state.compensation = Compensator(sink, state.position, plane=state.plane, side=actual,
                                         radius=abs(diameter) / 2, orientation=orientation)  # fmt: skip

    return on


def _of_words(block: Block, state: State, name: str) -> tuple[float, int]:
    """Return diameter [program units] and orientation from the words D and L."""
    if "d" not in block.values:
        raise block.fault(ParseError, f"{name} needs the tool's diameter", name, hint=f"Write D: {name} D6.")
    if "l" not in block.values:
        return block.values["d"], 0
    orientation = as_integer(block.values["l"])
    if orientation is None or not 0 <= orientation <= MOST_ORIENTATION:
        raise block.fault(ParseError, "L is the orientation of a lathe tool, 0 to 9", "l",
                          hint="Leave L out where the tool is round.")  # fmt: skip
    if state.plane != Plane.ZX:
        raise block.fault(ModalConflictError, "a lathe tool's orientation (L) needs the ZX plane", "l",
                          hint="Select G18, or leave L out.")  # fmt: skip
    return block.values["d"], orientation


def _of_table(block: Block, state: State, name: str) -> tuple[float, int]:
    """Return diameter [program units] and orientation of tool D, or of the tool in the spindle."""
    number = as_integer(block.values.get("d", 0.0))
    if number is None or number < 0:
        raise block.fault(ParseError, f"D of {name} is the number of a tool", "d",
                          hint=f"{name}.1 takes the diameter itself.")  # fmt: skip
    if state.tools is None:
        raise block.fault(ModalConflictError, f"{name} needs a tool table", name,
                          hint=f"Name one (--tools FILE), or write the diameter: {name}.1 D6.")  # fmt: skip
    tool = state.in_spindle if number == 0 else state.tools[slot_of(number, block, state, "d") - 1]
    return tool.diameter / state.scale, tool.orientation


def run_compensated(part: Code | WordCode, block: Block, state: State, sink: Sink) -> None:
    """Let a part of a line act while cutter compensation is on.

    Raises
    ------
    ModalConflictError
        For a code that cannot act now, and for a move the tool cannot make.
    """
    if isinstance(part, Code):
        if part.group == "shift":  # the reference leaves the shift as it is, without a word
            return
        _check_allowed(part, block, state)
    try:
        part.run(block, state, sink_of(state, sink))
    except GougeError as error:
        if state.compensation is not None:
            state.compensation.forget()
        raise block.fault(ModalConflictError, error.message, block.mover, hint=error.hint) from error


def sink_of(state: State, sink: Sink) -> Sink:
    """Return where canonical calls go now: to the compensation if it is on, which hands them on to ``sink``."""
    return sink if state.compensation is None else cast("Sink", state.compensation)


def _check_allowed(code: Code, block: Block, state: State) -> None:
    """Refuse what would change the path under a tool that stands beside it."""
    plane = PLANE_CODES.get(code.name, state.plane)
    if code.name in NOT_NOW or plane != state.plane:
        word = code.name if code.name in block.where else block.mover
        raise block.fault(ModalConflictError, f"{code.name} cannot act while cutter compensation is on", word,
                          hint="Write G40 and a straight move before it.")  # fmt: skip


G_CODES = table(
    Code(name="G40", about="no cutter compensation", group="compensation", step="compensation", run=off),
    Code(name="G41", about="tool D of the table left of the path", group="compensation", step="compensation",
         run=_on("G41", +1, _of_table), words="dl"),
    Code(name="G42", about="tool D of the table right of the path", group="compensation", step="compensation",
         run=_on("G42", -1, _of_table), words="dl"),
    Code(name="G41.1", about="tool of diameter D left of the path", group="compensation", step="compensation",
         run=_on("G41.1", +1, _of_words), words="dl"),
    Code(name="G42.1", about="tool of diameter D right of the path", group="compensation", step="compensation",
         run=_on("G42.1", -1, _of_words), words="dl"),
)  # fmt: skip
