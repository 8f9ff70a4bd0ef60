"""The linear speed controller as a state machine: one call a timer interrupt, one delay back.

In: a move's steps, accelerations and speed.  Out: the delay before each step [ticks], by Austin's recursion, which
needs one division a step.  ``core/shared/speed.h`` is the exact one, in whole ticks and without division.
Legend: alpha step angle [rad], f ticks a second, c delay [ticks], n steps (S1 A7, A8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from trochia.errors import LimitError
from trochia.pulses.ramps.austin import first_delay


class State(Enum):
    """What the controller is doing."""

    STOP = "stop"
    ACCEL = "accelerate"
    RUN = "run"
    DECEL = "brake"


@dataclass(frozen=True, slots=True, kw_only=True)
class MovePlan:
    """What is computed before a move.

    Attributes
    ----------
    steps
        Of the whole move.
    shortest, first
        Delay at speed, and before the first step [ticks].
    rising
        Steps to reach the speed.
    limit
        Step at which braking must begin however fast it is.
    braking
        Steps of braking, below 0 as they are counted from the end.
    """

    steps: int
    shortest: float
    first: float
    rising: int
    limit: int
    braking: int

    @property
    def brakes_at(self) -> int:
        """Step at which braking begins."""
        return self.steps + self.braking


def plan_move(
    steps: int,
    speed: float,
    acceleration: float,
    deceleration: float,
    *,
    angle: float,
    clock: float = 1e6,
    register: int | None = None,
) -> MovePlan:
    """Return what is computed before a move of ``steps`` steps.

    Parameters
    ----------
    speed, acceleration, deceleration
        [rad/s], [rad/s²].
    angle
        Of a step [rad].
    clock
        Ticks a second [Hz].
    register
        Bits of the timer's compare register; None: as many as it takes.

    Raises
    ------
    LimitError
        For a quantity that is not above 0, and for a first delay that the register cannot hold.
    """
    if steps < 1 or not min(speed, acceleration, deceleration, angle, clock) > 0.0:
        raise LimitError("a move has steps, a speed and accelerations above 0")
    first = clock * first_delay(acceleration / angle)
    if register is not None and first >= 2**register:
        raise LimitError(
            f"the first delay is {first:.0f} ticks, and a register of {register} bits holds {2**register - 1}",
            hint=f"A clock of at most {clock * (2**register - 1) / first:.6g} Hz would do, or at least "
            f"{acceleration * (first / (2**register - 1)) ** 2:.4g} rad/s².",
        )
    rising = int(speed**2 / (2.0 * angle * acceleration) + 1e-9)
    limit = int(steps * deceleration / (acceleration + deceleration) + 1e-9)
    # where the speed is reached, the source's text takes the limit here, which would brake far too early
    braking = -int(rising * acceleration / deceleration) if rising < limit else limit - steps
    return MovePlan(
        steps=steps,
        shortest=angle * clock / speed,
        first=first,
        rising=rising,
        limit=limit,
        braking=min(braking, -1) if steps > 1 else 0,
    )


class SpeedController:
    """One move, from interrupt to interrupt."""

    def __init__(self, plan: MovePlan) -> None:
        self.plan = plan
        self.state = State.STOP
        self.count = 0  #: steps made
        self._delay = 0.0

    def begin(self) -> float:
        """Return the delay before the first step [ticks]."""
        self.state, self.count = State.ACCEL, 0
        self._delay = self.plan.first
        return self._delay

    def interrupt(self) -> float | None:
        """Count the step that is made now, and return the delay before the next [ticks]; None: it was the last."""
        self.count += 1
        plan = self.plan
        if self.count >= plan.steps:
            self.state = State.STOP
            return None
        if self.count >= plan.brakes_at:
            self.state = State.DECEL
            self._delay -= 2.0 * self._delay / (4.0 * (self.count - plan.steps) + 1.0)
        elif self.state is State.ACCEL:
            self._delay -= 2.0 * self._delay / (4.0 * self.count + 1.0)
            if self._delay <= plan.shortest:
                self._delay, self.state = plan.shortest, State.RUN
        return self._delay


def delays(plan: MovePlan) -> list[float]:
    """Return the delay before every step of a move [ticks]."""
    controller = SpeedController(plan)
    made = [controller.begin()]
    while (delay := controller.interrupt()) is not None:
        made.append(delay)
    return made


def duration(plan: MovePlan, clock: float = 1e6) -> float:
    """Return the time of a whole move [s]."""
    return math.fsum(delays(plan)) / clock
