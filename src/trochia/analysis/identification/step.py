"""Models of a step response.  In: times, response, size of the step.  Out: gain, time constants, dead time.

first order    y = K u (1 - exp(-t / T))
FOPDT          the same after a dead time L
second order   y = K u (1 - exp(-z w t) (cos wd t + z w / wd sin wd t)),  wd = w sqrt(1 - z²); z >= 1 likewise
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.identification.estimate import Estimate, fitted
from trochia.errors import RecordingError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

FEWEST = 8  #: samples for a fit


def first_order(t: Array, gain: float, lag: float) -> Array:
    """Return the response to a unit step at t = 0."""
    return gain * -np.expm1(-np.maximum(t, 0.0) / lag)


def delayed(t: Array, gain: float, lag: float, dead: float) -> Array:
    """Return the response of first order to a unit step at t = 0, after a dead time."""
    return first_order(t - dead, gain, lag)


def second_order(t: Array, gain: float, frequency: float, damping: float) -> Array:
    """Return the response to a unit step at t = 0; frequency is the undamped one [rad/s]."""
    t = np.maximum(t, 0.0)
    root = np.sqrt(complex(1.0 - damping * damping)) * frequency
    decay = np.exp(-damping * frequency * t)
    if abs(root) < 1e-9 * frequency:
        return gain * (1.0 - decay * (1.0 + frequency * t))
    swing = np.cos(root * t) + damping * frequency / root * np.sin(root * t)
    return gain * (1.0 - (decay * swing).real)


MODELS = {
    "first-order": (first_order, (("gain", ""), ("lag", "s"))),
    "fopdt": (delayed, (("gain", ""), ("lag", "s"), ("dead", "s"))),
    "second-order": (second_order, (("gain", ""), ("frequency", "rad/s"), ("damping", ""))),
}


def fit_step(t: Array, y: Array, *, step: float = 1.0, model: str = "first-order") -> Estimate:
    """Return the model of a response y (samples,) to a step of this size at t = 0, from rest at 0.

    Raises
    ------
    RecordingError
        When there are too few samples, the response does not move, or no model fits.
    """
    t, y = np.asarray(t, np.float64), np.asarray(y, np.float64)
    if len(t) < FEWEST or t.shape != y.shape:
        raise RecordingError(f"a step response needs at least {FEWEST} samples, with a time each; there are {len(t)}")
    if not (np.isfinite(t).all() and np.isfinite(y).all()) or np.any(np.diff(t) <= 0.0):
        raise RecordingError("a step response needs rising times and finite samples")
    final = float(np.mean(y[-max(len(y) // 10, 1):]))  # fmt: skip
    if not step or abs(final) <= 1e-12 * max(1.0, float(np.abs(y).max())):
        raise RecordingError("the response does not move", hint="Step further, or look whether the drive was on.")
    function, names = MODELS[model]
    crossing = float(t[int(np.argmax(np.abs(y) >= 0.632 * abs(final)))])
    lag = max(crossing, 1e-3 * float(t[-1]))
    over = max(float(np.max(y / final)) - 1.0, 1e-3)
    damping = -np.log(over) / np.hypot(np.pi, np.log(over))
    starts = {
        "first-order": (final, lag),
        "fopdt": (final, lag, 0.05 * lag),
        "second-order": (final, 2.0 / lag, damping),
    }
    least = {"first-order": (-np.inf, 0.0), "fopdt": (-np.inf, 0.0, 0.0), "second-order": (-np.inf, 0.0, 0.0)}[model]
    try:
        found = fitted(model, function, t, y, start=starts[model], names=names, bounds=(least, [np.inf] * len(least)))
    except (RuntimeError, ValueError) as error:
        raise RecordingError(f"no {model} model fits the response: {error}") from error
    gain = found.numbers["gain"]
    found.numbers["gain"] = gain._replace(value=gain.value / step, sigma=gain.sigma / abs(step))
    return found
