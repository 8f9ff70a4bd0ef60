"""What an error is made of: its amplitude by frequency.  In: evenly spaced samples.  Out: a one-sided spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray

LEAST = 16  #: samples


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectrum:
    """Frequencies [Hz] and amplitudes (n,): a sine of amplitude 1 on a line of the spectrum shows 1 there."""

    frequency: NDArray[np.float64]
    amplitude: NDArray[np.float64]

    def peaks(self, most: int = 5) -> list[tuple[float, float]]:
        """Return the greatest local peaks as (frequency, amplitude), greatest first; the mean is none."""
        a = self.amplitude
        inner = np.flatnonzero((a[1:-1] > a[:-2]) & (a[1:-1] >= a[2:])) + 1
        inner = inner[np.argsort(-a[inner], kind="stable")][:most]
        return [(float(self.frequency[i]), float(a[i])) for i in inner]


def spectrum(values: NDArray[np.float64], period: float) -> Spectrum:
    """Return the spectrum of samples (samples,) ``period`` [s] apart, less their mean, through Hann's window.

    Raises
    ------
    LimitError
        For fewer than 16 samples, or values that are no numbers.
    """
    if len(values) < LEAST or not np.isfinite(values).all():
        raise LimitError(f"a spectrum needs at least {LEAST} samples, all of them numbers, not {len(values)}")
    window = np.hanning(len(values) + 1)[:-1]  # periodic
    amplitude = 2 * np.abs(np.fft.rfft((values - values.mean()) * window)) / window.sum()
    return Spectrum(frequency=np.asarray(np.fft.rfftfreq(len(values), period), np.float64), amplitude=amplitude)
