"""The chopper: today's step/dir driver, which holds each phase's current by switching the supply on and off.

In: the wanted level of a phase, its current and back-EMF.  Out: the voltage, switch by switch or on average.

Fixed off-time, peak current: the bridge drives the phase until its current reaches the wanted one, then lets it decay
for ``off_time``, and drives again.  For ``blanking`` after switching on the comparator looks away, as the switching
noise would trip it.  While it is off the phase is shorted (slow decay, 0 V), reversed (fast, minus the supply), or
first reversed and then shorted (mixed).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from trochia.errors import ConfigError
from trochia.machine.codecs import Number, Quantity, Text
from trochia.machine.drivers.chip import Chip, check_supply
from trochia.machine.drivers.voltage import CURRENT_LIMIT, EXCITATION, POWER_LIMIT, SUPPLY, WHEN_RELEASED
from trochia.machine.schema import Bound, check_bounds, key

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

DECAYS = ("slow", "fast", "mixed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Chopper:
    """A current-controlled driver."""

    kind: ClassVar[str] = "chopper"
    chip: ClassVar[Chip | None] = None

    supply: float = field(metadata=SUPPLY)
    current: float = field(metadata=key(Quantity("current"), "peak of a phase, as set at the driver", Bound.POSITIVE))
    off_time: float = field(
        default=20e-6, metadata=key(Quantity("time"), "off after the peak is reached", Bound.POSITIVE)
    )
    blanking: float = field(
        default=1e-6, metadata=key(Quantity("time"), "on at least, as the comparator looks away", Bound.NOT_NEGATIVE)
    )
    decay: str = field(default="mixed", metadata=key(Text(DECAYS), "how the current falls while off"))
    mixed: float = field(
        default=0.3, metadata=key(Number(), "part of the off time that is fast in mixed decay", Bound.NOT_NEGATIVE)
    )
    on_resistance: float = field(
        default=0.5, metadata=key(Quantity("resistance"), "of the switches in a phase's way, and the sense resistor",
                                  Bound.NOT_NEGATIVE)
    )  # fmt: skip
    hold_current: float = field(
        default=1.0, metadata=key(Number(), "part of the current that is left at rest", Bound.NOT_NEGATIVE)
    )
    hold_delay: float = field(
        default=0.1, metadata=key(Quantity("time"), "after the last step, until it is reduced", Bound.POSITIVE)
    )
    excitation: str | None = field(default=None, metadata=EXCITATION)
    released: str = field(default="open", metadata=WHEN_RELEASED)
    current_limit: float | None = field(default=None, metadata=CURRENT_LIMIT)
    power_limit: float | None = field(default=None, metadata=POWER_LIMIT)

    def __post_init__(self) -> None:
        check_bounds(self)
        check_supply(self.chip, self.kind, self.supply)
        for name in ("mixed", "hold_current"):
            if not 0 <= getattr(self, name) <= 1:
                raise ConfigError(f"must be 0 to 1, not {getattr(self, name):g}", key=name)
        if self.blanking >= self.off_time:
            raise ConfigError(
                f"must be below off_time ({self.off_time * 1e6:g} us), not {self.blanking * 1e6:g} us", key="blanking"
            )

    @property
    def phase_voltage(self) -> float:
        """Across a phase while it is driven [V]."""
        return self.supply

    @property
    def resistance(self) -> float:
        """What it adds to a phase [ohm]."""
        return self.on_resistance

    @property
    def fast_part(self) -> float:
        """Part of the off time in which the phase is reversed."""
        return {"slow": 0.0, "fast": 1.0, "mixed": self.mixed}[self.decay]

    @property
    def lowest(self) -> float:
        """Lowest voltage in the current's direction, on average over whole periods [V]: off, but for the blanking."""
        off = -self.fast_part * self.supply * self.off_time
        return (off + self.supply * self.blanking) / (self.off_time + self.blanking)

    def least_current(self, resistance: float) -> float:
        """Return the current below which it does not hold a phase of so much resistance in all [A]; 0: it holds any.

        In slow decay a current only falls by its own resistance, and the blanking drives it up in every period.  Where
        both are equal it stays, whatever less is asked: V t_blank/(R (t_off + t_blank)).  Mixed or fast decay pulls it
        down with the supply.
        """
        return max(0.0, self.lowest / resistance)

    def loss(self, rms: float, mean: float) -> float:
        """Return its heat for a phase that carries a current, effective and mean magnitude [A], in W."""
        del mean
        return self.on_resistance * rms * rms

    def ripple(self, current: Array, emf: Array, *, resistance: float, inductance: float) -> Array:
        """Return by how much a current falls in the off time (...) [A]: (R i + e + f V) t_off/L, f its fast part."""
        falling = resistance * current + emf + self.fast_part * self.supply
        return self.off_time / inductance * np.maximum(falling, 0.0)

    def mean_voltage(
        self, level: Array, current: Array, emf: Array, *, resistance: float, inductance: float, lag: float
    ) -> Array:
        """Return the voltage across a phase on average over chopping periods (...) [V].

        The current is drawn to the wanted one, less half the ripple, with the time constant ``lag`` (about a chopping
        period), within what the bridge can do: the supply upwards, :attr:`lowest` downwards.  At level zero the bridge
        is off and its diodes take the current down to nothing.

        Parameters
        ----------
        level
            Wanted current over :attr:`current`, -1 to 1 (...).
        resistance, inductance
            Of the whole phase, this driver included.
        """
        sign = np.where(level < 0, -1.0, 1.0)
        wanted = level * self.current
        ripple = self.ripple(np.abs(wanted), emf * sign, resistance=resistance, inductance=inductance)
        target = wanted - np.where(level == 0, 0.0, sign * np.minimum(0.5 * ripple, np.abs(wanted)))
        free = resistance * current + emf + inductance / lag * (target - current)
        low = np.where(current * sign > 0, self.lowest, 0.0)
        driven = sign * np.clip(free * sign, np.minimum(low, self.supply), self.supply)
        return np.where(level == 0, np.clip(free, -self.supply, self.supply), driven)
