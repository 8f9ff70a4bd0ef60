"""What an axis is excited with.

In: amplitudes, bands, durations.  Out: values injected at each tick (ticks,), or set-points (ticks, 3) of position,
speed and acceleration.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]


class Multisine(NamedTuple):
    """One period of a sum of sines: ``values`` (samples,) of unit RMS; ``lines`` in cycles a period."""

    values: Array
    lines: NDArray[np.int64]


def check_band(low: float, high: float, period: float) -> None:
    """Refuse a band that the sampling cannot carry.

    Raises
    ------
    ConfigError
        Naming the band that would do.
    """
    if not 0.0 < low < high <= 0.4 / period:
        raise ConfigError(f"from {low:g} to {high:g} Hz is no band for sampling at {1 / period:g} Hz", key="band",
                          hint=f"It may go up to {0.4 / period:g} Hz.")  # fmt: skip


def multisine(
    samples: int, period: float, band: tuple[float, float], *, step: float = 1.015, seed: int = 1,
    weight: Callable[[Array], Array] | None = None,
) -> Multisine:  # fmt: skip
    """Return a multisine of random phases on odd lines, spaced by a ratio ``step``.

    Even lines stay empty: what appears there comes from what is not linear.  ``weight`` gives each line's amplitude
    by its frequency [Hz]; None: all alike.
    """
    check_band(*band, period)
    first, last = (f * samples * period for f in band)
    count = max(2, math.ceil(math.log(last / first) / math.log(step)))
    lines = np.unique(2 * np.round((np.geomspace(first, last, count) - 1.0) / 2.0).astype(np.int64) + 1)
    amplitude = np.ones(len(lines)) if weight is None else weight(lines / (samples * period))
    spectrum = np.zeros(samples // 2 + 1, np.complex128)
    spectrum[lines] = amplitude * np.exp(2j * np.pi * np.random.default_rng(seed).random(len(lines)))
    values = np.fft.irfft(spectrum, samples)
    return Multisine(np.asarray(values / np.sqrt(np.mean(values**2)), np.float64), lines)


def chirp(samples: int, period: float, band: tuple[float, float]) -> Array:
    """Return a sine of unit amplitude whose frequency rises exponentially through the band (samples,)."""
    check_band(*band, period)
    low, high = band
    rate = math.log(high / low)
    t = np.arange(samples, dtype=np.float64) / samples
    return np.asarray(np.sin(2 * np.pi * low * samples * period * np.expm1(rate * t) / rate), np.float64)


def steady(start: float, speed: float, ticks: int, period: float) -> Array:
    """Return set-points at a steady speed from a position on."""
    t = period * np.arange(ticks, dtype=np.float64)
    return np.stack([start + speed * t, np.full(ticks, speed), np.zeros(ticks)], axis=1)


def change_speed(start: float, before: float, after: float, ticks: int, period: float) -> Array:
    """Return set-points from one speed to another at even acceleration."""
    a = (after - before) / (ticks * period)
    t = period * np.arange(ticks, dtype=np.float64)
    return np.stack([start + t * (before + 0.5 * a * t), before + a * t, np.full(ticks, a)], axis=1)


def end_of(wanted: Array, period: float) -> float:
    """Return the position a tick behind the last set-point."""
    x, v, a = wanted[-1]
    return float(x + period * (v + 0.5 * a * period))


def parabolic(start: float, distance: float, duration: float, period: float) -> Array:
    """Return a move whose speed is a parabola over time (its position a cubic), from rest to rest."""
    u = np.arange(round(duration / period) + 1, dtype=np.float64) * period / duration
    return np.stack([start + distance * u * u * (3.0 - 2.0 * u), distance / duration * 6.0 * u * (1.0 - u),
                     distance / duration**2 * (6.0 - 12.0 * u)], axis=1)  # fmt: skip


def step(start: float, distance: float, duration: float, period: float) -> Array:
    """Return a step at the first tick."""
    ticks = round(duration / period)
    return np.stack([np.full(ticks, start + distance), np.zeros(ticks), np.zeros(ticks)], axis=1)
