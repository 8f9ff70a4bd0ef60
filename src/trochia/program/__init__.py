"""What a program *is*: canonical moves in columns, sparse actions, each with its source line.

Machine coordinates, mm, degrees and s; after offsets, rotation, tool length and cutter compensation.  ``MOVE`` and
``Program`` are loaded on first use (PEP 562): they need numpy, and reading a program as text does not.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from trochia.program.actions import (
    Action,
    Coolant,
    Dwell,
    End,
    Log,
    Message,
    Orient,
    Output,
    Override,
    Pause,
    Probe,
    Spindle,
    SpindleLock,
    SurfaceSpeed,
    SynchronisedOutput,
    ToolChange,
    ToolNumber,
    Unfinished,
    UserCode,
    WaitInput,
)
from trochia.program.modes import AXES, MoveKind, PathMode, Plane, TimeLaw
from trochia.program.tools import NO_TOOL, Tool
from trochia.program.work import SYSTEMS, WorkState

if TYPE_CHECKING:
    from trochia.program.moves import MOVE
    from trochia.program.program import Program

__all__ = [
    "AXES",
    "MOVE",
    "NO_TOOL",
    "SYSTEMS",
    "Action",
    "Coolant",
    "Dwell",
    "End",
    "Log",
    "Message",
    "MoveKind",
    "Orient",
    "Output",
    "Override",
    "PathMode",
    "Pause",
    "Plane",
    "Probe",
    "Program",
    "Spindle",
    "SpindleLock",
    "SurfaceSpeed",
    "SynchronisedOutput",
    "TimeLaw",
    "Tool",
    "ToolChange",
    "ToolNumber",
    "Unfinished",
    "UserCode",
    "WaitInput",
    "WorkState",
]

_LATE = {"MOVE": "trochia.program.moves", "Program": "trochia.program.program"}


def __getattr__(name: str) -> Any:  # noqa: ANN401 - the types are those imported above
    """Return ``MOVE`` or ``Program``."""
    if name in _LATE:
        return getattr(import_module(_LATE[name]), name)
    raise AttributeError(f"module 'trochia.program' has no attribute {name!r}")
