"""The electronic leadscrew as it was built: a chip that counts, its whole-number PID, and its motor.

In: spindle speed, pitch, gains.  Out: the error at every spindle pulse, in pulses of the leadscrew.

The motor is the first-order lag that was identified: 2.0866 pulses/s a step of the PWM, pole 74.29 rad/s.  (The timer's
period was taken a count too short when it was: with the true one both are three quarters of that.)
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.kernels.follower import FollowerKernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

STEP = 8e-6  #: time step [s]
LEAD_MM = Fraction("3.175")


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowedSpindle:
    """What came of a run, each (spindle pulses,): time [s], error and position [pulses], duty [of the PWM's steps]."""

    time: NDArray[np.float64]
    error: NDArray[np.float64]
    duty: NDArray[np.float64]
    position: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ElectronicLeadscrew:
    """A leadscrew that follows a spindle.

    Attributes
    ----------
    p, i, d
        32 Kp, 32 Ki T, 32 Kd / T.
    mended
        Whether the derivative saturates in place of wrapping round.
    one_way
        Whether the motor is never driven backwards, as it was built: its encoder tells no direction.
    gain, pole
        Of the motor: pulses/s a step of the PWM, and 1/s.
    counts, spindle_counts
        Pulses a turn of the screw, and of the spindle.
    period
        Of the PID [s].
    """

    p: int = 2305
    i: int = 3
    d: int = 21003
    mended: bool = False
    one_way: bool = True
    gain: float = 2136.75 / 1024
    pole: float = 74.29
    counts: int = 780
    spindle_counts: int = 40
    lead_mm: Fraction = LEAD_MM
    period: float = 1.024e-3
    most: int = 1023

    def ratio(self, pitch_mm: Fraction) -> Fraction:
        """Return the screw's pulses for one of the spindle, exactly."""
        return pitch_mm / self.lead_mm * self.counts / self.spindle_counts

    @property
    def most_rate(self) -> float:
        """Pulses/s at full duty."""
        return self.gain * self.most

    def greatest_rpm(self, pitch_mm: Fraction) -> float:
        """Return the spindle speed that full duty just follows [rev/min]: beyond it the pitch is lost."""
        return self.most_rate / float(self.ratio(pitch_mm)) / self.spindle_counts * 60

    def run(self, rpm: float, pitch_mm: Fraction, duration: float, *, error: int = 0) -> FollowedSpindle:
        """Return what comes of starting at a spindle that turns already.

        Parameters
        ----------
        error
            Pulses owed at the start: what the last pass ran over.

        Raises
        ------
        ConfigError
            When the spindle does not turn.
        """
        if not rpm > 0:
            raise ConfigError(f"the spindle must turn, not {rpm!r} rpm", key="rpm")
        ratio, rate = self.ratio(pitch_mm), self.spindle_counts * rpm / 60
        kernel = FollowerKernel(
            {"h": STEP, "gain": self.gain, "pole": self.pole, "spindle": rate, "num": ratio.numerator,
             "den": ratio.denominator, "pid_steps": round(self.period / STEP), "one_way": int(self.one_way)},
            {"p": self.p, "i": self.i, "d": self.d, "most": self.most, "mended": int(self.mended)}, error=error,
        )  # fmt: skip
        time, off, duty, position = kernel.run(max(1, round(duration * rate))).T
        return FollowedSpindle(time=time, error=off, duty=duty, position=position)

    def coast(self) -> float:
        """Return the pulses it runs on from full speed once the duty is 0."""
        return self.most_rate / self.pole
