"""The step-response log of the electronic leadscrew: 400 periods between encoder pulses, kept in EEPROM.

In: an Intel HEX dump.  Out: speed over time, and its fit.  Byte 18 holds the timer's compare value, which the source
takes as that many ticks of 4 µs a count (the chip's timer takes one more); from byte 20 on stand 400 counts.  A lost
byte is taken from its row's check sum where that gives something like its neighbours, else it repeats the one before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.identification.estimate import Estimate, fitted
from trochia.errors import RecordingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.identification.intel_hex import Dump

COMPARE, FIRST, COUNT = 18, 20, 400  #: addresses and number of bytes
TICK = 4e-6  #: of the timer [s]
PULSES = 780  #: a turn of the screw
NEAR = 2  #: how far a byte by check sum may be from the one before [counts]
STEADY = 200  #: counts at the end that give the steady speed


@dataclass(frozen=True, slots=True, kw_only=True)
class StepLog:
    """Speed after a step of full duty.

    Attributes
    ----------
    counts
        Periods, repaired (400,) [units].
    unit
        Of a count [s].
    repaired
        Places that were not in the dump as they stand here.
    """

    counts: NDArray[np.int64]
    unit: float
    repaired: tuple[int, ...]

    @property
    def time(self) -> NDArray[np.float64]:
        """End of each period (400,) [s]."""
        return np.asarray(np.cumsum(self.counts) * self.unit, np.float64)

    @property
    def speed(self) -> NDArray[np.float64]:
        """Mean over each period (400,) [rad/s of the screw]."""
        return np.asarray(math.tau / (PULSES * self.counts * self.unit), np.float64)

    @property
    def steady(self) -> float:
        """Speed of the period most common at the end [rad/s]."""
        common = int(np.bincount(self.counts[-STEADY:]).argmax())
        return math.tau / (PULSES * common * self.unit)

    def pole(self, *, drop: int = 1) -> Estimate:
        """Return the fit steady - speed = amplitude exp(-pole t), without the first periods.

        The first period begins before the motor does: a dead time, which is why it is left out.
        """
        time, rest = self.time[drop:], self.steady - self.speed[drop:]
        return fitted(
            "first-order", _decay, time, rest,
            start=(float(rest[0]), 3.0 / float(time[COUNT // 8])), names=(("amplitude", "rad/s"), ("pole", "1/s")),
        )  # fmt: skip

    def gain(self, steps: int) -> float:
        """Return pulses a second for each step of a PWM of so many."""
        return self.steady * PULSES / math.tau / steps


def step_log(dump: Dump, *, extra: int = 0) -> StepLog:
    """Return the log in a dump.

    Parameters
    ----------
    extra
        1 counts the tick that the chip's timer takes beyond its compare value.

    Raises
    ------
    RecordingError
        When the log is not in it.
    """
    (compare,) = dump.block(COMPARE, 1, guess=True)
    bytes_ = dump.block(FIRST, COUNT)
    if not compare or all(value in {None, 0xFF} for value in bytes_):
        raise RecordingError(f"there is no step-response log in this dump: bytes {COMPARE} and {FIRST} on are empty")
    counts: list[int] = []
    repaired: list[int] = []
    for place, (value, guess) in enumerate(zip(bytes_, dump.block(FIRST, COUNT, guess=True), strict=True)):
        if value is None:
            before = counts[-1] if counts else guess or 1
            last = (place + FIRST) % 16 == 15
            value = guess if guess is not None and (not last or abs(guess - before) <= NEAR) else before  # noqa: PLW2901
            if last:
                repaired.append(place)
        if not value:
            raise RecordingError(f"byte {FIRST + place} of the log is 0: a period of no length")
        counts.append(value)
    return StepLog(counts=np.array(counts), unit=(compare + extra) * TICK, repaired=tuple(repaired))


def _decay(t: NDArray[np.float64], amplitude: float, pole: float) -> NDArray[np.float64]:
    return amplitude * np.exp(-pole * t)
