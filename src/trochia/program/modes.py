"""The small integers of a move and their names; light to import (no numpy).

The values are those of the enums in ``core/host/move.h``.
"""

from __future__ import annotations

from enum import IntEnum

AXES = "XYZABCUVW"  #: the nine axis letters, in the order of every array of targets


class MoveKind(IntEnum):
    """How a move gets to its target."""

    RAPID = 0
    FEED = 1
    ARC = 2
    SPLINE = 3


class Plane(IntEnum):
    """Plane of an arc; ``axes`` are the columns of its first and second axis, ``normal`` that of the third."""

    XY = 0
    YZ = 1
    ZX = 2

    @property
    def axes(self) -> tuple[int, int]:
        """Columns of the first and second axis (ZX: Z first, as counter-clockwise seen from +Y asks)."""
        return ((0, 1), (1, 2), (2, 0))[self]

    @property
    def normal(self) -> int:
        """Column of the axis along which a helix climbs."""
        return (2, 0, 1)[self]


class TimeLaw(IntEnum):
    """What a move's ``rate`` means: mm/s, mm per spindle revolution, or moves per second."""

    PER_SECOND = 0
    PER_REV = 1
    INVERSE = 2


class PathMode(IntEnum):
    """G64 without P (the machine's tolerance), G64 P, G61, G61.1."""

    BLEND_DEFAULT = 0
    BLEND = 1
    EXACT_PATH = 2
    EXACT_STOP = 3
