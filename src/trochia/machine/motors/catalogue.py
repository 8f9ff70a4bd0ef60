"""From a catalogue's row to the parameters of the equations.

A catalogue gives the holding torque, not the torque constant.  With one phase on, the torque is K i; with both, the two
torque curves stand 90 degrees apart and add up to √2 K i.  Catalogues mean both phases on unless they say otherwise, so

    K = holding torque / (√2 · rated current)      both phases on (the default)
    K = holding torque / rated current             one phase on

Taking one for the other makes back-EMF 41 % too great or 29 % too small, and the top speed as wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

from trochia.errors import ConfigError
from trochia.machine.codecs import Flag, Quantity, Text, Whole
from trochia.machine.motors.hybrid import HybridStepper
from trochia.machine.motors.plausible import check_plausible
from trochia.machine.schema import Bound, check_bounds, key


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueStepper:
    """A row of a catalogue of two-phase steppers, with its source."""

    kind: ClassVar[str] = "hybrid"

    full_steps: int = field(metadata=key(Whole(), "full steps a turn (1.8 degrees: 200)", Bound.POSITIVE))
    resistance: float = field(metadata=key(Quantity("resistance"), "of a phase", Bound.POSITIVE))
    inductance: float = field(metadata=key(Quantity("inductance"), "of a phase", Bound.POSITIVE))
    current: float = field(metadata=key(Quantity("current"), "rated, of a phase", Bound.POSITIVE))
    holding_torque: float = field(metadata=key(Quantity("torque"), "at rated current", Bound.POSITIVE))
    inertia: float = field(metadata=key(Quantity("inertia"), "of the rotor", Bound.POSITIVE))
    source: str = field(metadata=key(Text(), "where the numbers come from"))
    checked: bool = field(metadata=key(Flag(), "whether someone has read the source again for this row"))
    phases_on: int = field(default=2, metadata=key(Whole(), "phases on when the holding torque was taken"))
    detent_torque: float = field(default=0.0, metadata=key(Quantity("torque"), "without current", Bound.NOT_NEGATIVE))
    friction: float = field(default=0.0, metadata=key(Quantity("torque"), "of the bearings", Bound.NOT_NEGATIVE))
    voltage: float | None = field(default=None, metadata=key(Quantity("voltage"), "rated, if any", Bound.POSITIVE))
    note: str | None = field(default=None, metadata=key(Text(), "what a reader should know"))

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.full_steps % 4:
            raise ConfigError(f"must be a multiple of 4 for a motor of two phases, not {self.full_steps}",
                              key="full_steps")  # fmt: skip
        if self.phases_on not in (1, 2):
            raise ConfigError(f"must be 1 or 2, not {self.phases_on}", key="phases_on")
        if self.detent_torque >= self.holding_torque:
            raise ConfigError(
                f"must be below the holding torque of {self.holding_torque:g} N·m, not {self.detent_torque:g} N·m",
                key="detent_torque",
            )
        check_plausible(self)

    @property
    def torque_constant(self) -> float:
        """Torque constant of one phase [N·m/A]."""
        return self.holding_torque / (self.current * math.sqrt(self.phases_on))

    def parameters(self) -> HybridStepper:
        """Return what the equations need."""
        return HybridStepper(
            teeth=self.full_steps // 4,
            resistance=self.resistance,
            inductance=self.inductance,
            current=self.current,
            inertia=self.inertia,
            torque_constant=self.torque_constant,
            detent=self.detent_torque,
            friction=self.friction,
        )
