"""A relay with hysteresis in place of a controller: the axis swings, and tells its ultimate gain.

In: an axis, the size of the relay.  Out: :class:`Relayed`.  Ku = 4 d / (pi sqrt(a² - e²)): d relay, a amplitude of the
swing, e hysteresis (Astrom and Hagglund 1984); offset and friction that differ by direction are taken away by a bias
that makes both halves of a swing last alike.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.analysis.identification.estimate import Number
from trochia.analysis.tuning.models import Ultimate
from trochia.errors import LimitError, RecordingError
from trochia.experiments.perform import powered
from trochia.servo.axis import Loop

if TYPE_CHECKING:
    from trochia.experiments.protocol import AxisUnderTest, Bounds

_SKIPPED = 4  # swings before it is even
_ALIKE = 0.05  # how much the last swings may differ
_FEWEST = 3  # swings for a spread


class Relayed(NamedTuple):
    """Ultimate gain and period, each with the scatter of its swings; the amplitude; the bias that was needed."""

    gain: Number
    time: Number
    amplitude: float
    bias: float

    @property
    def ultimate(self) -> Ultimate:
        """What tuning rules take."""
        return Ultimate(gain=self.gain.value, time=self.time.value)


def relay(
    axis: AxisUnderTest, bounds: Bounds, *, size: float, hysteresis: float, swings: int = 12, most_time: float = 30.0
) -> Relayed:
    """Return the ultimate gain of command to position.

    Parameters
    ----------
    size
        Command of the relay.
    hysteresis
        Error at which it switches: above the encoder's count, so that noise does not switch it.

    Raises
    ------
    LimitError
        Before it moves where the relay is more than the bounds allow; while it moves where they are left.
    RecordingError
        When it does not swing evenly.
    """
    centre = axis.position
    here = np.array([[centre, 0.0, 0.0]])
    bounds.refuse(here, np.array([size]))
    least = 2.0 / axis.counts if axis.counts else 0.0
    if hysteresis < least:
        raise LimitError(f"a hysteresis of {hysteresis:.3g} is less than two counts ({least:.3g})",
                         hint="Nothing has moved.  Give a wider one.")  # fmt: skip
    sign, bias, switched = 1.0, 0.0, 0.0
    halves: list[tuple[float, float]] = []  # duration, extreme
    extreme = 0.0
    with powered(axis, Loop(period=axis.period)):
        for tick in range(round(most_time / axis.period)):
            command = max(-bounds.command, min(bounds.command, sign * size + bias))
            bounds.watch(axis.advance(here, np.array([command])))
            error = centre - axis.position
            extreme = error if abs(error) > abs(extreme) else extreme
            if sign * error < -hysteresis:
                now = tick * axis.period
                halves.append((now - switched, abs(extreme)))
                sign, switched, extreme = -sign, now, 0.0
                if len(halves) % 2 == 0 and len(halves) > 2:
                    one, two = halves[-2][0], halves[-1][0]
                    bias -= 0.2 * size * (two - one) / (two + one) * sign
                if len(halves) >= 2 * (swings + _SKIPPED):
                    break
    return _result(halves[2 * _SKIPPED :], size, hysteresis, bias)


def _result(halves: list[tuple[float, float]], size: float, hysteresis: float, bias: float) -> Relayed:
    even = np.array(halves[: len(halves) // 2 * 2]).reshape(-1, 2, 2)
    if len(even) < _FEWEST:
        raise RecordingError(f"only {len(even)} even swings were seen",
                             hint="Give a stronger relay, a smaller hysteresis, or more time.")  # fmt: skip
    times, amplitudes = even[:, :, 0].sum(axis=1), even[:, :, 1].mean(axis=1)
    if np.std(times[-_FEWEST:]) > _ALIKE * np.mean(times[-_FEWEST:]) or np.mean(amplitudes) <= hysteresis:
        raise RecordingError("the axis does not swing evenly",
                             hint="Give a stronger relay, or a wider hysteresis.")  # fmt: skip
    gains = 4.0 * size / (math.pi * np.sqrt(amplitudes**2 - hysteresis**2))
    many = math.sqrt(len(even))
    return Relayed(
        Number(float(gains.mean()), float(gains.std(ddof=1)) / many),
        Number(float(times.mean()), float(times.std(ddof=1)) / many, "s"), float(amplitudes.mean()), bias,
    )  # fmt: skip
