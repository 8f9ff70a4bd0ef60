"""Frequency responses of measured signals, each with its coherence.

In: samples of input and output, in a closed loop or an open one.  Out: output by input at frequencies.

*Periodic* excitation (a multisine): the joint input-output estimate.  Both signals are averaged over whole periods at
the lines that were excited, and divided; what the loop feeds back is in both, so it does no harm (Pintelon and
Schoukens, *System Identification*).  Noise follows from the scatter between periods, and lines left out of the
excitation tell how far the plant is from linear.

*Any* excitation (a chirp): Welch's spectra.  With the excitation r given, Gyr / Gur (the instrument takes the loop's
bias away); without, H1 = Gyu / Guu, which is true in open loop only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import RecordingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FEWEST_PERIODS = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class FrequencyResponse:
    """Output by input.

    Attributes
    ----------
    frequency
        Ascending (lines,) [Hz].
    value
        (lines,), complex.
    coherence
        (lines,), 1: all output is caused by the input.
    period
        Between samples [s].
    distortion
        Of the output: lines not excited over lines excited, noise taken off; None where none were left out.
    """

    frequency: Array
    value: NDArray[np.complex128]
    coherence: Array
    period: float
    distortion: float | None = None

    def trusted(self, least: float = 0.9) -> FrequencyResponse:
        """Return the lines whose coherence is at least so much."""
        keep = self.coherence >= least
        return replace(self, frequency=self.frequency[keep], value=self.value[keep], coherence=self.coherence[keep])

    @property
    def relative_sigma(self) -> Array:
        """Standard deviation of each line's magnitude over itself (lines,)."""
        coherence = np.clip(self.coherence, 1e-6, 1.0)
        return np.sqrt((1.0 - coherence) / coherence / 2.0)


def of_periods(u: Array, y: Array, lines: NDArray[np.int64], samples: int, period: float) -> FrequencyResponse:
    """Return the response from whole periods.

    Parameters
    ----------
    u, y
        Input and output (periods · samples,), steady; a ramp in y (a steady speed) is taken off.
    lines
        Excited, in cycles a period of ``samples`` samples.

    Raises
    ------
    RecordingError
        When there are fewer than two whole periods, or samples missing.
    """
    u, y = _checked(u, y)
    periods, rest = divmod(len(u), samples)
    if rest or periods < FEWEST_PERIODS:
        raise RecordingError(f"{len(u)} samples are not two or more whole periods of {samples}")
    n = np.arange(len(y))
    ramp = (y[-samples:].mean() - y[:samples].mean()) / (samples * (periods - 1))
    inputs, outputs = (np.fft.rfft(values.reshape(periods, samples), axis=1) / samples for values in (u, y - ramp * n))
    mean_u, mean_y = inputs.mean(axis=0), outputs.mean(axis=0)
    # a period's own scatter, in both signals together: the loop carries the noise of one into the other
    g = mean_y[lines] / mean_u[lines]
    scatter = outputs[:, lines] - g * inputs[:, lines]
    noise = (np.abs(scatter) ** 2).sum(axis=0) / (periods - 1) / periods
    signal = np.abs(mean_y[lines]) ** 2
    idle = np.setdiff1d(np.arange(lines[0], lines[-1]), lines)
    return FrequencyResponse(
        frequency=lines / (samples * period), value=g, coherence=np.asarray(signal / (signal + noise), np.float64),
        period=period, distortion=_distortion(outputs, idle, lines),
    )  # fmt: skip


def _distortion(outputs: NDArray[np.complex128], idle: NDArray[np.int64], lines: NDArray[np.int64]) -> float | None:
    """Return the ratio of lines not excited to lines excited, where it is more than noise."""
    if not len(idle):
        return None
    mean = outputs.mean(axis=0)
    noise = outputs[:, idle].var(axis=0, ddof=1) / len(outputs)
    weight = idle.astype(np.float64) ** 2  # speeds: a drift of the position is at its lowest lines
    power = np.maximum(((np.abs(mean[idle]) ** 2 - noise) * weight).mean(), 0.0)
    return float(np.sqrt(power / (np.abs(mean[lines] * lines) ** 2).mean()))


def of_spectra(
    u: Array, y: Array, period: float, *, excitation: Array | None = None, segment: int | None = None,
    band: tuple[float, float] | None = None,
) -> FrequencyResponse:  # fmt: skip
    """Return the response by Welch's method (Hann windows, halves overlapping).

    Parameters
    ----------
    u, y
        Input and output (samples,); their means and trends are taken off.
    excitation
        What was injected (samples,): needed where a loop is closed.
    segment
        Samples of a window; None: an eighth of all.
    band
        Lowest and highest frequency that was excited [Hz].

    Raises
    ------
    RecordingError
        When there are too few samples, or samples missing.
    """
    from scipy.signal import csd, detrend  # noqa: PLC0415 - scipy is slow to import

    u, y = _checked(u, y)
    size = len(u) // 8 if segment is None else segment
    if size < 16 or 2 * size > len(u):
        raise RecordingError(f"{len(u)} samples are too few for windows of {size}: at least 16, and twice a window")
    r = u if excitation is None else np.asarray(excitation, np.float64)
    u, y, r = (np.asarray(detrend(values), np.float64) for values in (u, y, r))

    def spectrum(a: Array, b: Array) -> NDArray[np.complex128]:
        return np.asarray(csd(a, b, fs=1.0 / period, nperseg=size, detrend="linear")[1], np.complex128)

    frequency = np.asarray(np.fft.rfftfreq(size, period), np.float64)
    ru, ry, rr, yy = spectrum(r, u), spectrum(r, y), spectrum(r, r).real, spectrum(y, y).real
    low, high = band or (frequency[1], 0.4 / period)
    keep = (frequency >= low) & (frequency <= high) & (np.abs(ru) > 0.0)
    coherence = np.abs(ry[keep]) ** 2 / np.maximum(rr[keep] * yy[keep], 1e-300)
    return FrequencyResponse(frequency=frequency[keep], value=ry[keep] / ru[keep],
                             coherence=np.clip(coherence, 0.0, 1.0), period=period)  # fmt: skip


def _checked(u: Array, y: Array) -> tuple[Array, Array]:
    u, y = np.asarray(u, np.float64), np.asarray(y, np.float64)
    if u.shape != y.shape or u.ndim != 1:
        raise RecordingError(f"input and output must have a sample each, not {u.shape} and {y.shape}")
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        place = int(np.argmax(~(np.isfinite(u) & np.isfinite(y))))
        raise RecordingError(
            f"sample {place} is missing", hint="Record again without gaps, or cut the recording there."
        )
    return u, y
