"""What is corrected between what a program asks of a joint and what its motor is told.

A machine file says both what a machine is like (``backlash``, ``screw_error``, ``squareness_error``: the twin has them)
and what the controller corrects (``compensation``, ``squareness``); what was measured belongs into the second.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from trochia.errors import ConfigError
from trochia.machine.codecs import Number, Quantity
from trochia.machine.error_table import ErrorTable, TableOfErrors
from trochia.machine.schema import Bound, check_bounds, key

MOST_SHARE = 0.5
MOST_SKEW = 1.0  #: of a pair of axes [degree]
PAIRS = ("XY", "XZ", "YZ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Compensation:
    """What is corrected of one joint.

    Attributes
    ----------
    backlash
        Lost motion that its motor makes up at a reversal [mm or degree].
    screw
        Error by place that its motor takes back.
    share
        Of the joint's limits, kept free for making up the backlash.
    """

    backlash: float = field(
        default=0.0,
        metadata=key(Quantity("length", motion=True), "lost motion made up at a reversal", Bound.NOT_NEGATIVE),
    )
    screw: ErrorTable | None = field(
        default=None,
        metadata=key(TableOfErrors(), "error by place that is taken back: how far beyond where it should be"),
    )
    share: float = field(
        default=0.2, metadata=key(Number(), "of the joint's limits, kept free for making up backlash", Bound.POSITIVE)
    )

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.share > MOST_SHARE:
            raise ConfigError(f"must be {MOST_SHARE} at most, not {self.share:g}", key="share")


@dataclass(frozen=True, slots=True, kw_only=True)
class Squareness:
    """By how much the angle between two axes is more than a right one [degree]: the second leans from the first."""

    XY: float = field(default=0.0, metadata=key(Quantity("angle"), "of X and Y, beyond 90 degrees"))
    XZ: float = field(default=0.0, metadata=key(Quantity("angle"), "of X and Z, beyond 90 degrees"))
    YZ: float = field(default=0.0, metadata=key(Quantity("angle"), "of Y and Z, beyond 90 degrees"))

    def __post_init__(self) -> None:
        check_bounds(self)
        for pair in PAIRS:
            if abs(getattr(self, pair)) > MOST_SKEW:
                raise ConfigError(f"must be within {MOST_SKEW:g} degree, not {getattr(self, pair):g}", key=pair)

    def leans(self) -> list[tuple[str, str, float]]:
        """Return (first axis, second axis, tangent): going along the second shifts the first by minus that much."""
        return [(pair[0], pair[1], math.tan(math.radians(getattr(self, pair)))) for pair in PAIRS
                if getattr(self, pair)]  # fmt: skip
