"""A loop judged on the twin: margins of its linear part, a step, a parabolic move; before and after side by side.

In: a plant, a loop.  Out: :class:`Judged`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.tuning.margins import Margins, loop_margins
from trochia.analysis.tuning.metrics import FollowingMetrics, StepMetrics, following_metrics, step_metrics
from trochia.errors import ConfigError, LimitError
from trochia.servo.axis import ServoAxis

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.kernels.servo import ServoSamples
    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Moves:
    """What is asked of a loop: a step's size, and a parabolic move's length and time."""

    step: float = 0.1
    way: float = 1.0
    time: float = 0.5
    listen: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """A loop and what it did: times (ticks,), step and move as they were measured, following error, current [A]."""

    loop: Loop
    margins: Margins
    step: StepMetrics
    following: FollowingMetrics
    step_time: Array
    step_response: Array
    move_time: Array
    move_error: Array
    move_current: Array

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints as metrics."""
        return self.step.figures() | self.following.figures()


def judge(plant: ServoPlant, loop: Loop, moves: Moves | None = None) -> Judged:
    """Return what a loop does.

    Raises
    ------
    ConfigError
        When the loop is unstable on the plant: it is not run at all.
    """
    asked = moves or Moves()
    margins = loop_margins(plant, loop)
    if not margins.stable:
        raise ConfigError("these gains are unstable on this plant", key="gains",
                          hint="Lower the speed gain, or put a notch at the resonance.")  # fmt: skip
    ticks, t = _times(asked.listen, loop.period)
    wanted = np.zeros((ticks, 3))
    wanted[:, 0] = asked.step
    response = _run(plant, loop, wanted).measured
    move = np.concatenate([_parabola(asked, loop.period), np.tile([asked.way, 0.0, 0.0], (ticks // 2, 1))])
    seen = _run(plant, loop, move)
    return Judged(
        loop=loop, margins=margins, step=step_metrics(t, response, asked.step),
        following=following_metrics(move, seen.measured), step_time=t, step_response=response,
        move_time=loop.period * np.arange(len(move), dtype=np.float64), move_error=move[:, 0] - seen.measured,
        move_current=seen.current,
    )  # fmt: skip


def _times(seconds: float, period: float) -> tuple[int, Array]:
    ticks = max(8, math.ceil(seconds / period))
    return ticks, period * np.arange(ticks, dtype=np.float64)


def _parabola(asked: Moves, period: float) -> Array:
    """Return a move whose speed is a parabola over time."""
    u = np.arange(round(asked.time / period) + 1, dtype=np.float64) * period / asked.time
    return np.stack([asked.way * u * u * (3.0 - 2.0 * u), asked.way / asked.time * 6.0 * u * (1.0 - u),
                     asked.way / asked.time**2 * (6.0 - 12.0 * u)], axis=1)  # fmt: skip


def _run(plant: ServoPlant, loop: Loop, wanted: Array) -> ServoSamples:
    try:
        return ServoAxis(plant, loop, step=2e-5).run(wanted)
    except LimitError as error:
        raise ConfigError(f"these gains are unstable on this plant: {error.message}", key="gains",
                          hint=error.hint) from None  # fmt: skip
