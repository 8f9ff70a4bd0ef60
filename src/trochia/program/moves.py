"""The columns of a move: ``MOVE`` is the C struct ``trochia_move``; the enums are its small integers."""

from __future__ import annotations

from trochia.kernels.layout import MOVE
from trochia.program.modes import AXES, MoveKind, PathMode, Plane, TimeLaw

__all__ = ["AXES", "MOVE", "MoveKind", "PathMode", "Plane", "TimeLaw"]
