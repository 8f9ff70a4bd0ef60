"""Gains of the continuous form as the integers of real controllers, and back.

**32nds** (electronic leadscrew): P = 32 Kp, I = 32 Ki T, D = 32 Kd / T, the output in steps of its PWM.

**PMAC** (its servo law with velocities in counts a servo cycle, ±32768 for ±10 V):

    output = Ix30 / 2¹⁹ · (Ix08 · (FE + (Ix32 CV + Ix35 CA) / 128 + Ix33 IE / 2²³) - Ix31 Ix09 AV / 128)

FE following error [counts], CV, CA commanded velocity and acceleration, AV actual velocity, IE sum of FE.
"""

from __future__ import annotations

from dataclasses import dataclass

from trochia.errors import LimitError
from trochia.servo.axis import Loop
from trochia.servo.pid import Pid, Windup

SCALE_32 = 32
MOST_16 = (1 << 16) - 1


def in_32nds(kp: float, ki: float, kd: float, period: float) -> tuple[int, int, int]:
    """Return P, I and D for a tick of ``period`` [s].

    Raises
    ------
    LimitError
        When a gain does not fit 16 bits, with the period that would do for it.
    """
    exact = {"P": SCALE_32 * kp, "I": SCALE_32 * ki * period, "D": SCALE_32 * kd / period}
    for name, value in exact.items():
        if not 0 <= round(value) <= MOST_16:
            hint = f"It fits from a period of {SCALE_32 * kd / MOST_16 * 1e3:.3g} ms on." if name == "D" else None
            raise LimitError(f"{name} = {value:.6g} does not fit 16 bits at a period of {period * 1e3:g} ms", hint=hint)
    p, i, d = (round(value) for value in exact.values())
    return p, i, d


@dataclass(frozen=True, slots=True, kw_only=True)
class PmacGains:
    """I-variables of one motor; the names are their numbers.

    Attributes
    ----------
    i30, i31, i32, i33, i35
        Proportional, derivative, velocity feed-forward, integral, acceleration feed-forward.
    i08, i09
        Position and velocity scale.
    i29
        Offset of the output [bits].
    i63, i69
        Limits of the integral and of the output [bits].
    """

    i30: int
    i31: int = 0
    i32: int = 0
    i33: int = 0
    i35: int = 0
    i08: int = 96
    i09: int = 96
    i29: int = 0
    i63: int = 4194304
    i69: int = 20480

    @property
    def bits_a_count(self) -> float:
        """Output for one count of following error [bits]."""
        return self.i30 * self.i08 / (1 << 19)

    def output(self, error: int, commanded: int, acceleration: int, actual: int, integral: int) -> int:
        """Return the output [bits] of the law, computed exactly and cut at ±Ix69."""
        inner = self.i08 * ((error << 23) + ((self.i32 * commanded + self.i35 * acceleration) << 16)
                            + self.i33 * integral) - self.i31 * self.i09 * (actual << 16)  # fmt: skip
        bits = (self.i30 * inner >> 42) + self.i29
        return max(-self.i69, min(self.i69, bits))

    def loop(self, counts: float, period: float, *, volts_full: float = 10.0) -> Loop:
        """Return the same law in physical units: position in the plant's units, command in volts.

        Parameters
        ----------
        counts
            A unit of motion.
        period
            Of the servo cycle [s].
        volts_full
            Volts of 32768 bits.
        """
        volts = volts_full / 32768
        gain = self.bits_a_count * counts * volts  # volts a unit of error
        damping = self.i30 * self.i31 * self.i09 / (1 << 26) * counts * volts * period
        return Loop(
            period=period,
            position=Pid(kp=gain, ki=gain * self.i33 / (1 << 23) / period, kd=damping, c=0.0, windup=Windup.HOLD,
                         limit=self.i69 * volts),
            viscous_forward=gain * self.i32 / 128 * period,
            acceleration_forward=gain * self.i35 / 128 * period * period,
            bias=self.i29 * volts,
            limit=self.i69 * volts,
        )  # fmt: skip
