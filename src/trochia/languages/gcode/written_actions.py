"""What a program does between moves, in a plain controller's words.  In: an action.  Out: lines, or a refusal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.errors import ProgramError, Source
from trochia.program import (
    Action,
    Coolant,
    Dwell,
    End,
    Message,
    Override,
    Pause,
    Probe,
    Spindle,
    SpindleLock,
    SurfaceSpeed,
    ToolChange,
    ToolNumber,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

_PROBES = {(True, True): "G38.2", (True, False): "G38.3", (False, True): "G38.4", (False, False): "G38.5"}


def words_of(action: Action, file: str, *, beam: bool) -> Sequence[str]:  # noqa: PLR0911 - a table
    """Return the lines an action is written as; none for what a plain controller does by itself.

    Parameters
    ----------
    beam
        The tool is a beam: it is switched on by M4, which darkens it where motion slows and at rest.

    Raises
    ------
    ProgramError
        For what it cannot do.
    """
    match action:
        case Dwell(seconds=seconds):
            return (f"G4P{seconds:.3f}",) if seconds > 0.0 else ()
        case Spindle(direction=0):
            return ("M5",)
        case Spindle(direction=direction, speed=speed):
            return (f"M{4 if beam or direction < 0 else 3}S{number(speed, 3)}",)
        case Coolant(mist=mist, flood=flood):
            return ("M9", *(("M7",) if mist else ()), *(("M8",) if flood else ()))
        case ToolChange(tool=tool):
            return f"T{tool}", "M0"
        case ToolNumber(tool=tool):
            return (f"T{tool}",)
        case Pause(optional=optional):
            return ("M1" if optional else "M0",)
        case End():
            return ("M2",)
        case Message() | Override() | Probe() | SpindleLock(pitch=0.0) | SurfaceSpeed(on=False):
            return ()
        case _:
            raise ProgramError(f"a plain controller has no {_name(action)}", source=Source(file, action.line),
                               hint="Take it out of the program, or run it on a backend that has it.")  # fmt: skip


def probe_word(action: Probe) -> str:
    """Return the G word of the move that probes."""
    return _PROBES[action.toward, action.must]


def number(value: float, decimals: int) -> str:
    """Return a number as short as it can be written; never -0, never with an exponent."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text in {"-0", ""} else text


def _name(action: Action) -> str:
    """Return what an action is, in small letters: ``wait input``."""
    name = type(action).__name__
    return "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()
