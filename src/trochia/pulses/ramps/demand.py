"""What a move is asked to be, in the step domain.

In: numbers in steps and seconds (the command line converts what a person types).  Out: a checked ``Demand``.
Legend: alpha step angle [rad], v speed [steps/s], a acceleration [steps/s²], J inertia [kg·m²], T torque [N·m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import LimitError

if TYPE_CHECKING:
    from trochia.pulses.ramps.curve import TorqueCurve

LONGEST = 1_000_000  #: steps of one move: its table is held whole
LEAST, MOST = 1e-12, 1e12  #: of every quantity in its unit: what lies outside is a slip of the pen
_LARGE = 1e15  # beyond it a float has no units to show
CLOCK = 1e6  #: timer clock unless given [Hz]
UPDATE = 1e-3  #: longest time between two settings of the speed in the linear law [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Demand:
    """A move from rest to rest, and what drives it.

    Attributes
    ----------
    steps, steps_per_turn
        Length of the move, and of a turn.
    speed
        Speed not to be exceeded [steps/s].
    acceleration, deceleration
        [steps/s²]; a law limited by torque needs neither, and without a deceleration it is the acceleration.
    start_stop
        Greatest speed to start at and stop from without losing steps [steps/s].
    curve, load, inertia
        Pull-out torque over speed, load torque [N·m], inertia of rotor and load [kg·m²].
    clock
        Of the timer that counts the delays [Hz].
    update
        Longest time between two settings of the speed, in the linear law [s].
    travel
        What a turn moves, where it is to be told [mm].
    """

    steps: int
    speed: float
    acceleration: float | None = None
    deceleration: float | None = None
    steps_per_turn: int = 200
    start_stop: float | None = None
    curve: TorqueCurve | None = None
    load: float = 0.0
    inertia: float | None = None
    clock: float = CLOCK
    update: float = UPDATE
    travel: float | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.steps <= LONGEST:
            raise LimitError(f"a move has 1 to {LONGEST} steps, not {self.steps}")
        if not 1 <= self.steps_per_turn <= LONGEST:
            raise LimitError(f"a turn has 1 to {LONGEST} steps, not {self.steps_per_turn}")
        for name, value in (("speed", self.speed), ("acceleration", self.acceleration), ("clock", self.clock),
                            ("deceleration", self.deceleration), ("start/stop speed", self.start_stop),
                            ("inertia", self.inertia), ("update time", self.update)):  # fmt: skip
            if value is not None and not 0.0 < value < math.inf:
                raise LimitError(f"the {name} must be more than 0, not {value:g}: such a move never arrives")
            if value is not None and not LEAST <= value <= MOST:
                raise LimitError(f"the {name} must be from {LEAST:g} to {MOST:g}, not {value:g}")
        if not 0.0 <= self.load < math.inf:
            raise LimitError(f"the load torque must be at least 0, not {self.load:g} N·m")
        if self.speed > self.clock:
            raise LimitError(
                f"{self.speed:g} steps/s is faster than the timer's clock of {self.clock:g} Hz",
                hint=f"At most {self.at_most(self.clock)}, or a faster clock.",
            )

    @property
    def step_angle(self) -> float:
        """The angle of a step [rad]."""
        return 2.0 * math.pi / self.steps_per_turn

    @property
    def rising(self) -> float:
        """The acceleration [steps/s²].

        Raises
        ------
        LimitError
            Where none is given.
        """
        if self.acceleration is None:
            raise LimitError(
                "this law needs an acceleration",
                hint='Give one, like "100 rad/s²"; the law `torque` takes it from a torque curve.',
            )
        return self.acceleration

    @property
    def falling(self) -> float:
        """The deceleration [steps/s²]; errors as in :attr:`rising`."""
        return self.rising if self.deceleration is None else self.deceleration

    def said(self, speed: float) -> str:
        """Return a speed [steps/s] as a person reads it."""
        return f"{shown(speed)} steps/s ({self._other(speed, 1)})"

    def said_acceleration(self, acceleration: float) -> str:
        """Return an acceleration [steps/s²] as a person reads it."""
        return f"{shown(acceleration)} steps/s² ({self._other(acceleration, 2)})"

    def at_most(self, speed: float) -> str:
        """Return a speed [steps/s] rounded down in every unit, so that what a person types of it is no more."""
        return f"{shown_down(speed)} steps/s ({self._other(speed, 1, down=True)})"

    def at_most_acceleration(self, acceleration: float) -> str:
        """Return an acceleration [steps/s²] rounded down in every unit."""
        return f"{shown_down(acceleration)} steps/s² ({self._other(acceleration, 2, down=True)})"

    def _other(self, value: float, order: int, *, down: bool = False) -> str:
        """Return a speed or an acceleration (``order`` 1, 2) in the other units."""
        show = shown_down if down else shown
        turns = value / self.steps_per_turn
        angular = f"{show(60.0 * turns)} rpm" if order == 1 else f"{show(value * self.step_angle)} rad/s²"
        along = "" if self.travel is None else f", {show(turns * self.travel)} mm/s{'²' * (order - 1)}"
        return angular + along


def shown(value: float) -> str:
    """Return a number with four digits, large ones without an exponent."""
    rounded = float(f"{value:.4g}")
    return f"{rounded:.0f}" if 1000.0 <= abs(rounded) < _LARGE else f"{rounded:.4g}"


def floor_to(value: float, digits: int = 4) -> float:
    """Return a number above 0 rounded down to so many digits, so that what is named does fit."""
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(value)))
    return math.floor(value * scale * (1.0 + 1e-12)) / scale


def shown_down(value: float) -> str:
    """Return a number as a person reads it, rounded down to four digits."""
    return shown(floor_to(value)) if value > 0.0 else shown(value)


def shown_up(value: float) -> str:
    """Return a number above 0 as a person reads it, rounded up to four digits."""
    down = floor_to(value)
    return shown(down if down >= value else down + 10.0 ** (math.floor(math.log10(value)) - 3))
