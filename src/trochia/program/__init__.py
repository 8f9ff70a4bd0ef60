"""What a program *is*: canonical moves in columns, sparse actions, each with its source line.

Machine coordinates, mm, degrees and s; after offsets, rotation, tool length and cutter compensation.
"""

from trochia.program.actions import (
    Action,
    Coolant,
    Dwell,
    End,
    Message,
    Pause,
    Spindle,
    ToolChange,
)
from trochia.program.moves import AXES, MOVE, MoveKind, PathMode, Plane, TimeLaw
from trochia.program.program import Program

__all__ = [
    "AXES",
    "MOVE",
    "Action",
    "Coolant",
    "Dwell",
    "End",
    "Message",
    "MoveKind",
    "PathMode",
    "Pause",
    "Plane",
    "Program",
    "Spindle",
    "TimeLaw",
    "ToolChange",
]
