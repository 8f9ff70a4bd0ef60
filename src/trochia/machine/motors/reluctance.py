"""Variable reluctance steppers: their geometry.

In: teeth of stator and rotor.  Out: step angle, steps a turn, and which way it goes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar

from trochia.errors import ConfigError
from trochia.machine.codecs import Whole
from trochia.machine.schema import Bound, check_bounds, key


@dataclass(frozen=True, slots=True, kw_only=True)
class ReluctanceStepper:
    """A single-stack motor; a phase is a set of opposed poles in series.

    Raises
    ------
    ConfigError
        When the teeth give no even steps: excited in turn, the phases must share out one pitch of the rotor.
    """

    kind: ClassVar[str] = "reluctance"

    poles: int = field(metadata=key(Whole(), "poles of the stator", Bound.POSITIVE))
    teeth: int = field(metadata=key(Whole(), "teeth of the rotor", Bound.POSITIVE))
    poles_per_phase: int = field(default=2, metadata=key(Whole(), "poles in series", Bound.POSITIVE))

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.poles % self.poles_per_phase or self.poles_per_phase % 2:
            raise ConfigError(f"must be even and divide the {self.poles} poles, not {self.poles_per_phase}",
                              key="poles_per_phase")  # fmt: skip
        if abs(self.poles - self.teeth) != self.poles_per_phase:
            raise ConfigError(
                f"must be {self.poles - self.poles_per_phase} or {self.poles + self.poles_per_phase} to step evenly "
                f"under {self.poles} poles, not {self.teeth}",
                key="teeth",
            )
        if self.phases < 3:
            raise ConfigError(
                f"must be at least {3 * self.poles_per_phase} for three phases, not {self.poles}: with two, forwards "
                "and backwards are the same order",
                key="poles",
            )

    @property
    def phases(self) -> int:
        """How many phases are excited in turn."""
        return self.poles // self.poles_per_phase

    @property
    def step_angle_deg(self) -> Fraction:
        """Angle of a step [degree], exactly: rotor pitch less pole pitch, |360/z - 360/l|."""
        return abs(Fraction(360, self.teeth) - Fraction(360, self.poles))

    @property
    def full_steps(self) -> int:
        """Steps a turn: phases times rotor teeth."""
        return self.phases * self.teeth

    @property
    def direction(self) -> int:
        """1 where the rotor follows the order of excitation, -1 where it turns against it (fewer teeth than poles)."""
        return 1 if self.teeth > self.poles else -1

    @property
    def phase_shift(self) -> float:
        """Shift between the pulse trains of neighbouring phases [rad of an excitation cycle]: 2π/m."""
        return math.tau / self.phases
