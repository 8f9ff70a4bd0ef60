"""PID controllers, as they are written down and as they are computed.

In: gains of the continuous form u = Kp e + Ki ∫e dt + Kd de/dt, how it is sampled, what it does at its limit.  Out: the
coefficients of one tick, and a controller in plain Python that says the same as ``core/host/servo.c``.

Sampling: backward Euler, s = (1 - 1/z) / T, or bilinear, s = (2 / T)(1 - 1/z) / (1 + 1/z).  The derivative may have a
filter, Kd s / (s/N + 1).  Positional and incremental forms give the same output as long as no limit is reached.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

from trochia.errors import ConfigError


class Sampling(Enum):
    """How s is replaced."""

    BACKWARD = "backward"
    BILINEAR = "bilinear"


class Windup(Enum):
    """What happens to the integral when the output is at its limit."""

    NONE = 0
    CLAMP = 1  # the integral has a bound of its own
    BACK = 2  # what the limit took away is taken off the integral, over ``track``
    HOLD = 3  # it does not grow further into the limit


@dataclass(frozen=True, slots=True, kw_only=True)
class Pid:
    """One controller.

    Attributes
    ----------
    kp, ki, kd
        Gains; ``ki`` per second, ``kd`` seconds.
    filter
        Corner of the derivative's filter N [rad/s]; None: no filter.
    b, c
        Parts of the set-point that the proportional and the derivative terms see (1 and 0 avoid a kick).
    limit
        Greatest output.
    sum_limit
        Greatest integral term, for ``Windup.CLAMP``.
    track
        Time of back-calculation [s].
    dead
        Errors within it are none.
    incremental
        Whether the output is a sum of changes; its memory is then the output, and a limit winds nothing up.
    """

    kp: float
    ki: float = 0.0
    kd: float = 0.0
    filter: float | None = None
    b: float = 1.0
    c: float = 1.0
    sampling: Sampling = Sampling.BACKWARD
    windup: Windup = Windup.HOLD
    limit: float = math.inf
    sum_limit: float = math.inf
    track: float | None = None
    dead: float = 0.0
    incremental: bool = False

    def __post_init__(self) -> None:
        for name in ("kp", "ki", "kd"):
            if not math.isfinite(getattr(self, name)):
                raise ConfigError(f"must be a number, not {getattr(self, name)!r}", key=name)
        for name in ("filter", "track"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < math.inf:
                raise ConfigError(f"must be above zero, not {value!r}", key=name)
        if self.windup is Windup.BACK and self.track is None:
            raise ConfigError("back-calculation needs the time over which it acts", key="track")
        if self.sampling is Sampling.BILINEAR and self.kd and self.filter is None:
            raise ConfigError("a bilinear derivative without a filter rings for ever", key="filter",
                              hint="Give it a filter, or sample by backward differences.")  # fmt: skip

    def members(self, period: float) -> dict[str, Any]:
        """Return the members of ``trochia_pid`` for a tick of ``period`` [s]."""
        n, t = self.filter, period
        if self.sampling is Sampling.BILINEAR:
            now = before = 0.5 * self.ki * t
            keep = 0.0 if n is None else (2.0 - n * t) / (2.0 + n * t)
            gain = 0.0 if n is None else 2.0 * self.kd * n / (2.0 + n * t)
        else:
            now, before = self.ki * t, 0.0
            keep = 0.0 if n is None else 1.0 / (1.0 + n * t)
            gain = self.kd / t if n is None else self.kd * n * keep
        return {
            "p": self.kp, "b": self.b, "c": self.c, "i_now": now, "i_before": before, "d_keep": keep, "d_gain": gain,
            "most": self.limit, "most_sum": self.sum_limit, "back": 0.0 if self.track is None else t / self.track,
            "dead": self.dead, "windup": self.windup.value, "incremental": int(self.incremental),
        }  # fmt: skip


class PidController:
    """One controller at work, in plain Python.

    ``compute_output`` is pure; ``update`` takes note of what was really put out, so that any limit behind the
    controller winds nothing up.
    """

    def __init__(self, pid: Pid, period: float) -> None:
        self._m = pid.members(period)
        self._windup = pid.windup
        self.sum = self.derivative = self.output = self.error = self.damped = self.proportional = 0.0

    def _terms(self, wanted: float, measured: float) -> tuple[float, float, float, float]:
        m = self._m
        error = wanted - measured
        error = 0.0 if abs(error) <= m["dead"] else error
        proportional = m["p"] * (error if m["dead"] > 0.0 else m["b"] * wanted - measured)
        derivative = m["d_keep"] * self.derivative + m["d_gain"] * (m["c"] * wanted - measured - self.damped)
        return error, proportional, derivative, m["i_now"] * error + m["i_before"] * self.error

    def _sum(self, proportional: float, derivative: float, more: float) -> float:
        grown = self.sum + more
        if self._windup is Windup.CLAMP:
            return _between(grown, self._m["most_sum"])
        beyond = abs(proportional + derivative + grown) > self._m["most"]
        pushing = (proportional + derivative + self.sum) * more > 0.0
        return self.sum if self._windup is Windup.HOLD and beyond and pushing else grown

    def compute_output(self, wanted: float, measured: float) -> float:
        """Return the output for a set-point and a measurement; nothing is remembered."""
        _, proportional, derivative, more = self._terms(wanted, measured)
        if self._m["incremental"]:
            change = proportional - self.proportional + more + derivative - self.derivative
            return _between(self.output + change, self._m["most"])
        total = proportional + self._sum(proportional, derivative, more) + derivative
        return _between(total, self._m["most"])

    def update(self, wanted: float, measured: float, realised: float) -> None:
        """Take note of a tick: what was wanted, measured, and put out."""
        error, proportional, derivative, more = self._terms(wanted, measured)
        if not self._m["incremental"]:
            self.sum = self._sum(proportional, derivative, more)
            if self._windup is Windup.BACK:
                self.sum += self._m["back"] * (realised - (proportional + self.sum + derivative))
        self.output, self.error, self.proportional, self.derivative = realised, error, proportional, derivative
        self.damped = self._m["c"] * wanted - measured


def _between(value: float, most: float) -> float:
    return max(-most, min(most, value))
