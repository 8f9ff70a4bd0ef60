"""Frequency response of an axis in its loop: a multisine in the command, at a steady speed.

At a steady speed friction keeps its sign and the flanks of a gap stay in touch, so that what is measured is linear;
lines left out of the multisine tell whether it was, and it is repeated more gently until it is.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.analysis.identification.response import FrequencyResponse, of_periods, of_spectra
from trochia.analysis.identification.two_mass import coupling_response
from trochia.errors import RecordingError
from trochia.experiments.perform import perform
from trochia.experiments.signals import change_speed, chirp, end_of, multisine, steady

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.analysis.identification.estimate import Estimate
    from trochia.experiments.protocol import AxisUnderTest, Bounds
    from trochia.kernels.servo import ServoSamples
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]

_RAMP = 0.5
_SETTLE = 1.5
_LEAST_PASSED = 0.1  # by the train, as the weight of a line takes it: above the peak lines would grow too strong
_SEEDS = 40
DISTORTED = 0.004  #: of the output: no longer linear
_GROWN = 1.3
NOISY = 0.2  #: of the output: too much, whatever it comes from
TRIES = 10


class Excitation(NamedTuple):
    """How an axis is excited: torque RMS, band [Hz], steady speed, time of a period [s], periods listened to.

    ``weight`` is the multisine's amplitude by frequency; None: rising as its root, as responses fall.
    """

    torque: float
    band: tuple[float, float]
    speed: float
    time: float = 4.096
    periods: int = 4
    seed: int = 1
    weight: Callable[[Array], Array] | None = None


def through_train(axis: AxisUnderTest, found: Estimate, most: float, speed: float) -> Excitation:
    """Return the excitation around notch and peak of a first estimate that keeps a gap closed.

    Each line gives the drive train about the same torque, and at no time more than ``most``: as long as friction holds
    the load back by more than that, the flanks stay in touch.
    """
    band = (max(0.1 * found["notch"], 1.0), min(2.5 * found["peak"], 0.4 / axis.period))
    base = Excitation(1.0, band, speed, periods=8)

    def weight(frequency: Array) -> Array:
        return 1.0 / (_LEAST_PASSED + np.abs(coupling_response(found, frequency)))

    samples = round(base.time / axis.period)
    best, crest = base, np.inf
    for seed in range(_SEEDS):
        sines = multisine(samples, axis.period, band, seed=seed, weight=weight)
        spectrum = np.fft.rfft(sines.values)
        spectrum[sines.lines] *= coupling_response(found, sines.lines / (samples * axis.period))
        peak = float(np.abs(np.fft.irfft(spectrum, samples)).max())
        if peak < crest:
            best, crest = base._replace(seed=seed, torque=most / peak, weight=weight), peak
    return best


def by_multisine(axis: AxisUnderTest, loop: Loop, bounds: Bounds, given: Excitation) -> FrequencyResponse:
    """Return position by torque.

    Raises
    ------
    LimitError
        As :func:`~trochia.experiments.perform.perform`.
    RecordingError
        When it is not linear however gently it is excited.
    """
    samples = round(given.time / axis.period)
    given = given._replace(periods=min(given.periods, _fitting(axis, bounds, given)))
    sines = multisine(samples, axis.period, given.band, seed=given.seed, weight=given.weight or np.sqrt)
    torque = given.torque
    before: FrequencyResponse | None = None
    for _ in range(TRIES):
        values = np.tile(sines.values * torque / axis.torque, given.periods + 1)
        seen, quiet = _at_speed(axis, loop, bounds, given.speed, values)
        part = slice(quiet + samples, quiet + samples * (given.periods + 1))
        found = of_periods(seen.command[part] * axis.torque, seen.measured[part], sines.lines, samples, axis.period)
        left = found.distortion or 0.0
        if left < DISTORTED:
            return found
        if before is not None and _GROWN * (before.distortion or 0.0) < left and (before.distortion or 0.0) < NOISY:
            return before  # it grew as the excitation fell: that is the encoder's noise, not what is not linear
        before = found
        torque *= 0.6
    raise RecordingError(f"the axis is not linear even under {torque / 0.6:.3g} N·m",
                         hint="Run it faster, so that friction keeps its sign and a gap stays closed.")  # fmt: skip


def _fitting(axis: AxisUnderTest, bounds: Bounds, given: Excitation) -> int:
    """Return the whole periods that fit the travel where there is more of it; two at least, which are then refused."""
    way = max(bounds.high - axis.position, axis.position - bounds.low)
    return max(2, math.floor((0.95 * way / given.speed - _RAMP - _SETTLE) / given.time) - 1)


def by_chirp(axis: AxisUnderTest, loop: Loop, bounds: Bounds, given: Excitation) -> FrequencyResponse:
    """Return position by torque, with a chirp of ``time`` and the excitation as the instrument."""
    samples = round(given.time / axis.period)
    values = np.tile(chirp(samples, axis.period, given.band) * given.torque * 2**0.5 / axis.torque, given.periods)
    seen, quiet = _at_speed(axis, loop, bounds, given.speed, values)
    part = slice(quiet, quiet + len(values))
    return of_spectra(seen.command[part] * axis.torque, seen.measured[part], axis.period, excitation=values,
                      segment=samples, band=given.band)  # fmt: skip


def _at_speed(axis: AxisUnderTest, loop: Loop, bounds: Bounds, speed: float, values: Array) -> tuple[ServoSamples, int]:
    """Return the samples of a run at a steady speed with values injected, and how many ticks they begin late."""
    if axis.position > 0.5 * (bounds.low + bounds.high):  # where there is more way
        speed = -speed
    ramp, settle = round(_RAMP / axis.period), round(_SETTLE / axis.period)
    up = change_speed(axis.position, 0.0, speed, ramp, axis.period)
    even = steady(end_of(up, axis.period), speed, settle + len(values), axis.period)
    down = change_speed(end_of(even, axis.period), speed, 0.0, ramp, axis.period)
    quiet = ramp + settle
    injected = np.concatenate([np.zeros(quiet), values, np.zeros(ramp)])
    return perform(axis, loop, bounds, np.concatenate([up, even, down]), injected), quiet
