"""Encoders: what a machine file says of what measures a position, and of its faults.

In: numbers with their units.  Out: frozen rows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.codecs import Flag, Number, Quantity, Ratio, Whole
from trochia.machine.edges import Edges
from trochia.machine.schema import Bound, check_bounds, key

if TYPE_CHECKING:
    from fractions import Fraction


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """Counts a turn (after quadrature), on the motor's shaft or on the load (then counts a mm or degree)."""

    counts: Fraction = field(
        metadata=key(
            Ratio(), "counts a turn of the shaft, all edges counted; on the load: a mm or degree", Bound.NOT_ZERO
        )
    )
    on_load: bool = field(default=False, metadata=key(Flag(), "a scale on the load instead of the motor's shaft"))
    index: bool = field(default=False, metadata=key(Flag(), "gives an index pulse once a turn"))
    channels: int = field(default=2, metadata=key(Whole(), "2 in quadrature; 1 tells no direction"))
    jitter: float = field(
        default=0.0, metadata=key(Number(), "standard deviation of an edge's place, in counts", Bound.NOT_NEGATIVE)
    )
    missed: float = field(
        default=0.0, metadata=key(Number(), "part of the edges that are not counted", Bound.NOT_NEGATIVE)
    )
    clock: float | None = field(
        default=None, metadata=key(Quantity("frequency"), "that times edges: speed is by the time between them",
                                   Bound.POSITIVE)
    )  # fmt: skip
    seed: int = field(default=1, metadata=key(Whole(), "of what is drawn", Bound.NOT_NEGATIVE))

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.channels not in (1, 2):
            raise ConfigError(f"must be 1 or 2, not {self.channels}", key="channels")
        _ = self.edges

    @property
    def edges(self) -> Edges | None:
        """Its edges where they have to be looked at one by one; None: whole counts, no more."""
        if self.channels == 2 and not self.jitter and not self.missed and self.clock is None:
            return None
        whole = self.index and not self.on_load and self.counts.denominator == 1
        return Edges(jitter=self.jitter, missed=self.missed, clock=self.clock, single=self.channels == 1,
                     turn=abs(int(self.counts)) if whole else None, seed=self.seed)  # fmt: skip
