"""Models that tuning rules work on, and the gains they give.

In: parameters.  Out: responses L(jw), and gains of u = Kp (e + 1/Ti ∫e dt + Td de/dt).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Response = NDArray[np.complex128]


_NEEDS_DEAD_TIME = "These rules live on dead time; a plant without any takes pole placement."


@dataclass(frozen=True, slots=True, kw_only=True)
class Fopdt:
    """gain exp(-dead s) / (lag s + 1)."""

    gain: float
    lag: float
    dead: float

    def __post_init__(self) -> None:
        for name in ("lag", "dead"):
            if not getattr(self, name) > 0.0:
                raise ConfigError(f"must be above zero, not {getattr(self, name)!r}", key=name, hint=_NEEDS_DEAD_TIME)
        if self.gain == 0.0:
            raise ConfigError("must not be zero", key="gain")

    def response(self, w: Array) -> Response:
        """Return G(jw)."""
        return np.asarray(self.gain * np.exp(-1j * w * self.dead) / (1j * w * self.lag + 1.0), np.complex128)


@dataclass(frozen=True, slots=True, kw_only=True)
class Integrating:
    """gain exp(-dead s) / s."""

    gain: float
    dead: float

    def __post_init__(self) -> None:
        if self.gain == 0.0 or not self.dead > 0.0:
            raise ConfigError("needs a gain that is not zero and a dead time above zero", key="dead")

    def response(self, w: Array) -> Response:
        """Return G(jw)."""
        return np.asarray(self.gain * np.exp(-1j * w * self.dead) / (1j * w), np.complex128)


@dataclass(frozen=True, slots=True, kw_only=True)
class Ultimate:
    """Where a loop with a proportional controller swings for ever: its gain, and the time of a swing [s]."""

    gain: float
    time: float
    plant_gain: float | None = None

    def __post_init__(self) -> None:
        if not (self.gain > 0.0 and self.time > 0.0):
            raise ConfigError("the ultimate gain and its period must be above zero", key="ultimate")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """u = kp e + ki ∫e dt + kd de/dt, the derivative through a filter of corner ``filter`` [rad/s] (None: none)."""

    kp: float
    ki: float = 0.0
    kd: float = 0.0
    filter: float | None = None

    def response(self, w: Array) -> Response:
        """Return C(jw)."""
        s = 1j * w
        derivative = self.kd * s if self.filter is None else self.kd * s / (s / self.filter + 1.0)
        return np.asarray(self.kp + self.ki / s + derivative, np.complex128)

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        return {"kp": self.kp, "ki": self.ki, "kd": self.kd, "filter_rad_s": self.filter}
