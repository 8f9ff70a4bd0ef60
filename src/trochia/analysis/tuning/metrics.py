"""What a move says of a loop: rise, overshoot, settling, following error; and which feed-forward would help.

In: times, set-points, samples.  Out: numbers.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.errors import RecordingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class StepMetrics:
    """Of a step.

    Attributes
    ----------
    rise, settling
        From 10 to 90 %, and until it stays within 2 % [s]; infinity: never.
    overshoot
        Part of the step.
    error
        Left at the end, part of the step.
    """

    rise: float
    settling: float
    overshoot: float
    error: float

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        return {f"{k}_s" if k in {"rise", "settling"} else k: v if math.isfinite(v) else None
                for k, v in asdict(self).items()}  # fmt: skip


def step_metrics(t: Array, y: Array, size: float, *, start: float = 0.0, band: float = 0.02) -> StepMetrics:
    """Return the metrics of a response y (samples,) to a step of ``size`` at t = 0.

    Times lie between samples, by straight lines.

    Raises
    ------
    RecordingError
        When the step is none.
    """
    if size == 0.0 or len(t) < 3 or len(t) != len(y):
        raise RecordingError("a step response needs a step, and three samples or more")
    part = (np.asarray(y, np.float64) - start) / size
    outside = np.nonzero(np.abs(part - 1.0) > band)[0]
    last = int(outside[-1]) if len(outside) else -1
    settling = math.inf
    if last + 1 < len(t):
        edge = 1.0 - band if last >= 0 and part[last] < 1.0 else 1.0 + band
        settling = 0.0 if last < 0 else _between(t, part, last, edge)
    return StepMetrics(
        rise=_first(t, part, 0.9) - _first(t, part, 0.1), settling=settling,
        overshoot=max(float(part.max()) - 1.0, 0.0), error=float(abs(part[-1] - 1.0)),
    )  # fmt: skip


def _first(t: Array, part: Array, level: float) -> float:
    there = np.nonzero(part >= level)[0]
    if not len(there):
        return math.inf
    return float(t[0]) if there[0] == 0 else _between(t, part, int(there[0]) - 1, level)


def _between(t: Array, part: Array, i: int, level: float) -> float:
    return float(t[i] + (t[i + 1] - t[i]) * (level - part[i]) / (part[i + 1] - part[i]))


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingMetrics:
    """Of a move.

    Attributes
    ----------
    peak, rms
        Following error.
    speed_part, acceleration_part, friction_part
        By how much it goes with speed [s], acceleration [s²] and the way of motion [unit of the error]: what
        feed-forward would take away.
    """

    peak: float
    rms: float
    speed_part: float
    acceleration_part: float
    friction_part: float

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        return {"following_error_peak": self.peak, "following_error_rms": self.rms,
                "with_speed_s": self.speed_part, "with_acceleration_s2": self.acceleration_part,
                "with_way": self.friction_part}  # fmt: skip


def following_metrics(wanted: Array, measured: Array) -> FollowingMetrics:
    """Return the metrics of set-points (ticks, 3) and what was measured (ticks,)."""
    error = wanted[:, 0] - measured
    columns = np.column_stack([wanted[:, 1:3], np.sign(wanted[:, 1])])
    scale = np.maximum(np.abs(columns).max(axis=0), 1e-300)  # so that the fit is not one of rounding
    parts = np.linalg.lstsq(columns / scale, error, rcond=None)[0] / scale
    return FollowingMetrics(
        peak=float(np.abs(error).max()), rms=float(np.sqrt(np.mean(error**2))), speed_part=float(parts[0]),
        acceleration_part=float(parts[1]), friction_part=float(parts[2]),
    )  # fmt: skip
