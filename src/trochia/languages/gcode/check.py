"""A sorted line against the modal state: what moves, and whether every word is read by someone.

In: a :class:`~trochia.languages.gcode.block.Block`.  Out: the same with its ``motion``; nothing has acted yet.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError
from trochia.languages.gcode.groups.diameter import halve
from trochia.languages.gcode.numbers import as_integer
from trochia.languages.gcode.polar import POLAR, check_polar
from trochia.languages.gcode.registry import G_CODES, WORDS
from trochia.languages.gcode.state import NO_MOTION

if TYPE_CHECKING:
    from trochia.languages.gcode.block import Block
    from trochia.languages.gcode.codes import Code
    from trochia.languages.gcode.state import State

_ARCS = (20, 30)
_ARC_CODES = ("G2", "G3")
_OPEN = frozenset(WORDS) | frozenset("xyzabcuvw") | frozenset(POLAR)  # letters that need no code beside them
_WHOLE_TURNS = 1e-3  # P of an arc may miss an integer by this


def check(block: Block, state: State) -> None:
    """Decide the line's motion and check that its words make sense together.

    Raises
    ------
    ModalConflictError
        For axis words no code takes or two codes want, or a code the present mode forbids.
    ParseError
        For a word that no code on the line reads, or a word that is missing.
    """
    halve(block, state)
    block.motion = _motion_of(block, state)
    if len(block.values) > len(block.axes):
        _check_readers(block)
        if block.is_polar:
            check_polar(block, state)
    other = block.groups.get("non-modal")
    if other is not None:
        _check_non_modal(block, state, other)
    if block.motion is not None and block.motion.name in _ARC_CODES and "p" in block.values:
        _check_turns(block)
    if block.motion is not None and block.motion.check is not None:
        block.motion.check(block, state)


def _motion_of(block: Block, state: State) -> Code | None:
    """Return the motion code that acts on this line, or None."""
    explicit = block.groups.get("motion")
    other = block.groups.get("non-modal")
    taker = other if other is not None and other.takes_axes else None
    if explicit is not None and explicit.name != "G80":
        if taker is not None:
            raise block.fault(ModalConflictError, f"{explicit.name} and {taker.name} both use the axis words",
                              explicit.name, hint="Use two lines.")  # fmt: skip
        return explicit
    if taker is not None or "G43.1" in block.where:
        return None
    if block.has_target:
        return _modal_motion(block, state, explicit)
    if explicit is None and state.motion in _ARCS and not block.values.keys().isdisjoint("ijk"):
        return G_CODES[state.motion]
    return None


def _modal_motion(block: Block, state: State, explicit: Code | None) -> Code:
    """Return the modal motion code that takes the line's axis words."""
    if explicit is None and state.motion != NO_MOTION:
        return G_CODES[state.motion]
    first = min((letter for letter in block.values if letter in "xyzabcuvw@^"), key=lambda letter: block.where[letter])
    why = "G80 stands on the line" if explicit is not None else "no motion code is in force"
    raise block.fault(ModalConflictError, f"nothing takes the axis word {first.upper()}: {why}", first,
                      hint="Write G0, G1, G2 or G3.")  # fmt: skip


def _check_readers(block: Block) -> None:
    """Check that every word is read by a code of the line."""
    readers = block.codes if block.motion is None else [*block.codes, block.motion]
    for letter in block.values:
        if letter == "$" and "s" in block.values:
            continue
        if letter not in _OPEN and not any(letter in code.words for code in readers):
            users = sorted({code.name for code in G_CODES.values() if letter in code.words})
            hint = f"It is read by {' '.join(users)}." if users else "No code known here reads it."
            raise block.fault(ParseError, f"no code on this line reads the word {letter.upper()}", letter, hint=hint)


def _check_non_modal(block: Block, state: State, other: Code) -> None:
    """Check what G4, G53 and G92 ask of their line."""
    if other.check is not None:
        other.check(block, state)
    elif other.name == "G4":
        _check_dwell(block)
    elif other.name in ("G92", "G52") and not block.axes:
        raise block.fault(ParseError, f"{other.name} has no axis word", other.name,
                          hint=f"Write the axes to set, like {other.name} X0.")  # fmt: skip
    elif other.name == "G53":
        _check_machine_coordinates(block, state)


def _check_dwell(block: Block) -> None:
    if block.values.get("p", -1.0) < 0:
        raise block.fault(ParseError, "G4 has no time", "G4", hint="Write it as P, in seconds: G4 P0.5.")
    if block.groups.get("motion") is not None and block.groups["motion"].name in _ARC_CODES:
        raise block.fault(ModalConflictError, "G4 and an arc would both read P", "G4", hint="Use two lines.")


def _check_machine_coordinates(block: Block, state: State) -> None:
    if block.motion is None or block.motion.name not in ("G0", "G1"):
        raise block.fault(ModalConflictError, "G53 needs a straight motion", "G53", hint="Write G53 G0 or G53 G1.")
    distance = block.groups.get("distance")
    absolute = state.absolute if distance is None else distance.name == "G90"
    if not absolute:
        raise block.fault(ModalConflictError, "G53 needs absolute distances", "G53", hint="Write G90 on this line.")


def _check_turns(block: Block) -> None:
    turns = as_integer(block.values["p"], _WHOLE_TURNS)
    if turns is None or turns < 1:
        raise block.fault(ParseError, "P of an arc counts its turns: 1, 2, 3 and so on", "p",
                          hint="Leave P out for an arc of less than a turn.")  # fmt: skip
