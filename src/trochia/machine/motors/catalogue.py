"""From a catalogue's row to the parameters of the equations.

A catalogue gives the holding torque, not the torque constant.  With one phase on, the torque is K i; with both, the two
torque curves stand 90 degrees apart and add up to √2 K i.  Catalogues mean both phases on unless they say otherwise, so

    K = holding torque / (√2 · rated current)      both phases on (the default)
    K = holding torque / rated current             one phase on

Taking one for the other makes back-EMF 41 % too great or 29 % too small, and the top speed as wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from datetime import date

from trochia.errors import ConfigError
from trochia.machine.codecs import Flag, Quantity, Text, Whole
from trochia.machine.motors.hybrid import HybridStepper
from trochia.machine.motors.plausible import check_plausible
from trochia.machine.schema import Bound, check_bounds, key
from trochia.units import did_you_mean

KINDS = ("hybrid", "permanent-magnet")  #: the same equations, other teeth: a hybrid's 50, a magnet's 5 to 24 pole pairs


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueStepper:
    """A row of a catalogue of two-phase steppers, with its source."""

    full_steps: int = field(metadata=key(Whole(), "full steps a turn (1.8 degrees: 200, 7.5: 48)", Bound.POSITIVE))
    resistance: float = field(metadata=key(Quantity("resistance"), "of a phase", Bound.POSITIVE))
    inductance: float = field(metadata=key(Quantity("inductance"), "of a phase", Bound.POSITIVE))
    current: float = field(metadata=key(Quantity("current"), "rated, of a phase", Bound.POSITIVE))
    holding_torque: float = field(metadata=key(Quantity("torque"), "at rated current", Bound.POSITIVE))
    inertia: float = field(metadata=key(Quantity("inertia"), "of the rotor", Bound.POSITIVE))
    kind: str = field(default="hybrid", metadata=key(Text(KINDS), "how the rotor is made"))
    phases_on: int = field(default=2, metadata=key(Whole(), "phases on when the holding torque was taken"))
    detent_torque: float = field(default=0.0, metadata=key(Quantity("torque"), "without current", Bound.NOT_NEGATIVE))
    friction: float = field(default=0.0, metadata=key(Quantity("torque"), "of the bearings", Bound.NOT_NEGATIVE))
    viscous: float = field(
        default=0.0, metadata=key(Quantity("viscous friction"), "friction that grows with speed: eddy currents in the "
                                  "iron, grease", Bound.NOT_NEGATIVE)
    )  # fmt: skip
    voltage: float | None = field(default=None, metadata=key(Quantity("voltage"), "rated, if any", Bound.POSITIVE))
    frame: str | None = field(default=None, metadata=key(Text(), 'its size, like "NEMA 17"'))
    source: str | None = field(default=None, metadata=key(Text(), "where the numbers come from"))
    checked: bool = field(
        default=False, metadata=key(Flag(), "whether every number but the assumed ones was read in the source again")
    )
    read: str | None = field(default=None, metadata=key(Text(), 'when it was, "2026-11-23"'))
    assumed: str | None = field(
        default=None, metadata=key(Text(), 'keys that no source gives, like "inertia, friction"')
    )
    note: str | None = field(default=None, metadata=key(Text(), "what a reader should know"))

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.full_steps % 4:
            below = self.full_steps // 4 * 4
            raise ConfigError(
                f"must be a multiple of 4 for a motor of two phases, not {self.full_steps}",
                key="full_steps",
                hint=f"{below} or {below + 4} would do; half steps and microsteps are not counted here."
                if below else "4 is the least; the usual ones are 200, 400 and 48.",
            )  # fmt: skip
        if self.phases_on not in (1, 2):
            raise ConfigError(f"must be 1 or 2, not {self.phases_on}", key="phases_on")
        if self.detent_torque >= self.holding_torque:
            raise ConfigError(
                f"must be below the holding torque of {self.holding_torque:g} N·m, not {self.detent_torque:g} N·m",
                key="detent_torque",
            )
        check_plausible(self)
        self._check_origin()

    def _check_origin(self) -> None:
        """Refuse a row that says it was checked, and not where, when, or against what."""
        known = [one.name for one in fields(self)]
        for name in self.assumed_keys:
            if name not in known:
                raise ConfigError(f"{name!r} is no key of a motor", key="assumed", hint=did_you_mean(name, known))
        if self.read is not None:
            try:
                date.fromisoformat(self.read)
            except ValueError:
                raise ConfigError(f'expected a day, like "2026-11-23", not {self.read!r}', key="read") from None
        for name in ("source", "read"):
            if self.checked and getattr(self, name) is None:
                raise ConfigError("missing; a row that was checked says in what and when", key=name)

    @property
    def assumed_keys(self) -> tuple[str, ...]:
        """Keys whose numbers no source gives."""
        return tuple(name.strip() for name in (self.assumed or "").split(",") if name.strip())

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
            viscous=self.viscous,
        )
