"""What a machine does wrong: data, never an exception."""

from __future__ import annotations

from enum import Enum

import msgspec


class Cause(Enum):
    """Why the machine stopped; each has its remedy in ``trochia.controller.alarms``."""

    FOLLOWING_WARNING = "following-warning"
    FOLLOWING = "following-error"
    SOFT_LIMIT = "soft-limit"
    HARD_LIMIT = "hard-limit"
    LINK = "link-lost"
    UNDERRUN = "underrun"
    DRIVE = "drive-fault"
    OVER_SPEED = "over-speed"
    ESTOP = "emergency-stop"
    DOOR = "door"
    HOMING = "homing"
    PROBE = "probe"
    PROGRAM = "program"
    POWER = "power-loss"
    INTERNAL = "internal"


class Fault(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One fault, as it was when it was seen.

    Attributes
    ----------
    cause
        What it is.
    time
        When [s of the controller's clock].
    axis
        Which axis or joint, if it is one's.
    value, limit
        The figure that was out of bounds, and the bound, in ``unit``.
    line
        Source line under way; 0: none.
    message
        One sentence for people.
    remedy
        What to do about it.
    warning
        It is told, and stops nothing.
    """

    cause: Cause
    time: float
    message: str
    remedy: str
    axis: str = ""
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    line: int = 0
    warning: bool = False
