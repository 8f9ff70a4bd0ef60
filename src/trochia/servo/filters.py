"""Filters between a loop and its amplifier: second-order sections, sampled.

In: corner frequencies and damping.  Out: coefficients of y = (b0 + b1/z + b2/z²) / (1 + a1/z + a2/z²) x, by the
bilinear transform with the corner kept in place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Biquad:
    """Coefficients; ``a0`` is 1."""

    b0: float
    b1: float
    b2: float
    a1: float
    a2: float

    def response(self, frequency: NDArray[np.float64], period: float) -> NDArray[np.complex128]:
        """Return the frequency response at frequencies [Hz] (any shape)."""
        z = np.exp(-2j * math.pi * frequency * period)
        above = self.b0 + z * (self.b1 + z * self.b2)
        return np.asarray(above / (1.0 + z * (self.a1 + z * self.a2)), np.complex128)


def _section(numerator: tuple[float, float, float], denominator: tuple[float, float, float], k: float) -> Biquad:
    """Return the section of analogue polynomials (s², s, 1) under s = k (1 - 1/z) / (1 + 1/z)."""
    (b2, b1, b0), (a2, a1, a0) = numerator, denominator
    whole = a2 * k * k + a1 * k + a0
    return Biquad(
        (b2 * k * k + b1 * k + b0) / whole, 2.0 * (b0 - b2 * k * k) / whole, (b2 * k * k - b1 * k + b0) / whole,
        2.0 * (a0 - a2 * k * k) / whole, (a2 * k * k - a1 * k + a0) / whole,
    )  # fmt: skip


def _corner(frequency: float, period: float) -> tuple[float, float]:
    """Return the corner [rad/s] and the k that keeps it in place."""
    if not 0.0 < frequency * period < 0.5:
        raise ConfigError(f"a filter of {frequency:g} Hz needs sampling above {2 * frequency:g} Hz, "
                          f"not {1 / period:g} Hz", key="frequency")  # fmt: skip
    corner = 2.0 * math.pi * frequency
    return corner, corner / math.tan(0.5 * corner * period)


def notch(frequency: float, period: float, *, width: float = 0.5, depth: float = 0.0) -> Biquad:
    """Return a notch at a frequency [Hz]: (s² + depth·width w s + w²) / (s² + width w s + w²).

    ``width`` is about its width over its frequency, ``depth`` what is left in the middle (0: nothing).
    """
    w, k = _corner(frequency, period)
    return _section((1.0, depth * width * w, w * w), (1.0, width * w, w * w), k)


def low_pass(frequency: float, period: float, *, damping: float = math.sqrt(0.5)) -> Biquad:
    """Return a low-pass of second order (by default Butterworth's) with its corner at a frequency [Hz]."""
    w, k = _corner(frequency, period)
    return _section((0.0, 0.0, w * w), (1.0, 2.0 * damping * w, w * w), k)


def first_order(frequency: float, period: float) -> Biquad:
    """Return a low-pass of first order with its corner at a frequency [Hz]."""
    w, k = _corner(frequency, period)
    return _section((0.0, 0.0, w), (0.0, 1.0, w), k)
