"""From a standard train of pulses to phases: the two ways a stepper is commanded.

In: instants of pulses, each with a direction.  Out: the pulses as the motor gets them, and which phases are on after
each.

    hard-wired   the computer gives direction and count; a digital filter spaces the pulses, a register distributes them
    programmed   the computer's own ramp gives calibrated trains, and software distributes them

Both splits are free: any train may go through a filter or not, and any distributor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from trochia.errors import ConfigError
from trochia.units import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray


class Distributor(Protocol):
    """Turns a pulse and its direction into phases, shifted by 2π/m from one to the next."""

    def step(self, direction: int) -> tuple[bool, ...]:
        """Take a pulse and return which phases are on."""
        ...


@dataclass(slots=True)
class RingCounter:
    """A ring of flip-flops with ``on`` neighbours set: they move round by one at each pulse.

    Attributes
    ----------
    phases
        m, at least 2.
    on
        How many phases are on at a time: 1, or 2 for more torque.
    """

    phases: int
    on: int = 1
    state: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        if self.phases < 2 or not 1 <= self.on < self.phases:
            raise ConfigError(f"a ring has at least 2 phases and fewer on than it has, not {self.on} of {self.phases}")

    def step(self, direction: int) -> tuple[bool, ...]:
        """Take a pulse and return which phases are on (phases,)."""
        self.state = (self.state + direction) % self.phases
        return self.present

    @property
    def present(self) -> tuple[bool, ...]:
        """Which phases are on."""
        return tuple((phase - self.state) % self.phases < self.on for phase in range(self.phases))


@dataclass(slots=True)
class ShiftRegister:
    """A register whose bits are moved round through its ends: any pattern, half steps among them.

    ``rows`` are words of ``phases`` bits, most significant first, one a step of an electrical turn.
    """

    phases: int
    rows: tuple[int, ...]
    state: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        if self.phases < 2:
            raise ConfigError(f"a register has at least 2 phases, not {self.phases}")
        if not self.rows or any(not 0 < row < 1 << self.phases for row in self.rows):
            raise ConfigError(
                f"each row of a register of {self.phases} phases has some of its bits set, not {self.rows}"
            )

    @classmethod
    def half_steps(cls, phases: int) -> ShiftRegister:
        """Return one phase and two in turn, 2m steps an electrical turn."""
        one = [1 << (phases - 1 - phase) for phase in range(phases)]
        both = [one[phase] | one[(phase + 1) % phases] for phase in range(phases)]
        return cls(phases, tuple(row for pair in zip(one, both, strict=True) for row in pair))

    def step(self, direction: int) -> tuple[bool, ...]:
        """Take a pulse and return which phases are on (phases,)."""
        self.state = (self.state + direction) % len(self.rows)
        word = self.rows[self.state]
        return tuple(bool(word >> (self.phases - 1 - phase) & 1) for phase in range(self.phases))


@dataclass(slots=True)
class SoftwareDistributor:
    """A counter and a table in the computer's memory, in place of a ring or a register.

    ``rows`` (steps, phases) say which phases are on, one electrical turn.
    """

    rows: NDArray[np.bool_]
    state: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        if self.rows.ndim != 2 or not len(self.rows) or self.rows.shape[1] < 2:
            raise ConfigError(f"a table has rows of at least 2 phases, not the shape {self.rows.shape}")

    def step(self, direction: int) -> tuple[bool, ...]:
        """Take a pulse and return which phases are on (phases,)."""
        self.state = (self.state + direction) % len(self.rows)
        return tuple(bool(on) for on in self.rows[self.state])


@dataclass(frozen=True, slots=True, kw_only=True)
class DigitalFilter:
    """Keeps pulses apart: no pulse is lost, each waits until the motor can follow it.

    Attributes
    ----------
    top
        Greatest rate [1/s].
    start
        Greatest rate from rest, and on a change of direction [1/s].
    acceleration
        Greatest change of rate at a rate, as the torque-speed characteristic gives it [1/s²]; None: none is asked.
    """

    top: float
    start: float
    acceleration: Callable[[float], float] | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.start <= self.top < math.inf:
            raise ConfigError(f"the rate from rest lies above 0 and not above the top of {self.top:g}/s, "
                              f"not {self.start:g}/s")  # fmt: skip

    def spaced(self, times: ArrayLike, directions: ArrayLike) -> NDArray[np.float64]:
        """Return when each pulse leaves the filter (pulses,) [s]: none before it came, none too near the one before.

        Over an interval T that follows one at rate f, the rate may rise to sqrt(f² + 2 a(f)): equal acceleration over
        one step.  It may fall at any time: who brakes is the one that sends the pulses, and it must send them so.
        """
        came, signs = np.asarray(times, np.float64), np.asarray(directions)
        if came.shape != signs.shape or np.any(np.diff(came) < 0.0):
            raise ConfigError("pulses come in order, each with its direction")
        left = np.empty_like(came)
        last, rate, sign = -math.inf, 0.0, 0
        for k, (time, direction) in enumerate(zip(came.tolist(), signs.tolist(), strict=True)):
            if direction != sign:
                rate, sign = 0.0, direction
            most = min(self.top, self._after(rate))
            left[k] = max(time, last + 1.0 / most)
            rate = 0.0 if math.isinf(last) else min(1.0 / (left[k] - last), most)
            last = float(left[k])
        return left

    def _after(self, rate: float) -> float:
        if self.acceleration is None or rate < self.start:
            return self.start if self.acceleration is not None else self.top
        return math.sqrt(rate * rate + 2.0 * self.acceleration(rate))


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandChain:
    """Who shapes the ramp, and who distributes the phases.

    Attributes
    ----------
    distributor
        ``RingCounter`` or ``ShiftRegister`` where hardware does it, ``SoftwareDistributor`` where the computer does.
    filter
        The digital filter that shapes the ramp; None where the computer's train is calibrated already.
    """

    distributor: Distributor
    filter: DigitalFilter | None = None

    def commanded(self, times: ArrayLike, directions: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return when the pulses reach the motor (pulses,) [s], and which phases are on after each (pulses, phases).

        Raises
        ------
        ConfigError
            For pulses out of order, or without a direction each.
        """
        came = np.asarray(times, np.float64)
        left = came if self.filter is None else self.filter.spaced(came, directions)
        return left, distributed(self.distributor, directions)


#: mode of excitation -> the distributor of m phases that makes it
DISTRIBUTORS: dict[str, Callable[[int], RingCounter | ShiftRegister]] = {
    "one-phase": RingCounter,
    "two-phase": lambda phases: RingCounter(phases, on=2),
    "half-step": ShiftRegister.half_steps,
}


def phase_table(mode: str, phases: int) -> NDArray[np.bool_]:
    """Return which of m phases are on through an electrical turn (steps, phases), from the distributor's rest on.

    One-phase and two-phase have m steps a turn, half-step 2m.

    Raises
    ------
    ConfigError
        For a mode that no distributor makes, or phases it cannot have.
    """
    if mode not in DISTRIBUTORS:
        raise ConfigError(f"no distributor makes {mode!r}; known are {', '.join(DISTRIBUTORS)}",
                          hint=did_you_mean(mode, DISTRIBUTORS))  # fmt: skip
    made = DISTRIBUTORS[mode](phases)
    steps = len(made.rows) if isinstance(made, ShiftRegister) else phases
    return np.roll(distributed(made, np.ones(steps)), 1, axis=0)  # the last pulse is back at the rest


def distributed(distributor: Distributor, directions: ArrayLike) -> NDArray[np.bool_]:
    """Return which phases are on after each pulse (pulses, phases)."""
    return np.array([distributor.step(int(direction)) for direction in np.asarray(directions)], np.bool_)
