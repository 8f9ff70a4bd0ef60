"""How an axis swings after a move, and the shaper that is to cancel it."""

from __future__ import annotations

from dataclasses import dataclass, field

from trochia.errors import ConfigError
from trochia.machine.codecs import Number, Quantity, Text
from trochia.machine.schema import Bound, check_bounds, key

#: names of the input shapers; ``trochia.planner.shaping.SHAPERS`` gives their impulses
SHAPERS = ("zv", "zvd", "mzv", "ei")
_MOST_DAMPING = 0.9  # a swing that hardly is one: impulses far apart, and all but the first nothing


@dataclass(frozen=True, slots=True, kw_only=True)
class Resonance:
    """The lowest resonance of an axis, as identification found it.

    Attributes
    ----------
    frequency
        Of the swinging itself, undamped [Hz].
    damping
        Ratio: 0 swings for ever, 1 not at all.
    shaper
        A name of :data:`SHAPERS`; None leaves motion as it was planned.
    """

    frequency: float = field(metadata=key(Quantity("frequency"), "undamped frequency of the resonance", Bound.POSITIVE))
    damping: float = field(default=0.0, metadata=key(Number(), "damping ratio, at most 0.9", Bound.NOT_NEGATIVE))
    shaper: str | None = field(default=None, metadata=key(Text(SHAPERS), "input shaper that cancels it"))

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.damping > _MOST_DAMPING:
            raise ConfigError(f"must be at most {_MOST_DAMPING:g}, not {self.damping:g}", key="damping")
