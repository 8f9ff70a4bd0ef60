"""What happens between moves.  An action stands *before* the move with index ``at`` (``at == len(moves)``: the end)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """Something that is not motion; ``line`` is its source line.  Motion is at rest while any of these acts."""

    at: int
    line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwell(Action):
    """Wait (s)."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Spindle(Action):
    """Spindle or beam: direction +1 clockwise (M3), -1 counter-clockwise (M4), 0 off (M5); speed as S gave it (rpm)."""

    direction: int
    speed: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Coolant(Action):
    """Coolant as it is from here on: mist (M7) and flood (M8)."""

    mist: bool
    flood: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolChange(Action):
    """Change to a tool (M6)."""

    tool: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Message(Action):
    """Text for the operator."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Pause(Action):
    """Program stop (M0), or optional stop (M1)."""

    optional: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class End(Action):
    """Program end (M2, M30): spindle, beam and coolant off."""
