"""Loop shaping: the quickest cascade that keeps its distance from instability.

In: a model of the axis.  Out: a Loop of position (P) around speed (PI), with a notch where it helps, and feed-forward
that makes the following error of the model vanish.

All gains hang on one frequency w, the crossover of the speed loop: kp = J w, ki = kp w / 6, position gain w / 4.  w is
raised as far as Ms allows, without a notch and with notches of two widths at the model's peak; of the loops found the
one that settles first on the twin is taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.tuning.margins import is_stable
from trochia.analysis.tuning.metrics import StepMetrics, step_metrics
from trochia.errors import ConfigError, LimitError
from trochia.machine.servo_plant import Mode
from trochia.servo.axis import Loop, ServoAxis
from trochia.servo.filters import notch
from trochia.servo.forward import feed_forward
from trochia.servo.pid import Pid
from trochia.servo.sampled import controller_response, plant_response

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.filters import Biquad

    Array = NDArray[np.float64]
    Response = NDArray[np.complex128]

MS = 1.6  #: by default: a little below the 1.7 that is commonly taken for robust
INTEGRAL, POSITION = 6.0, 4.0  #: the integral's corner and the position loop, below the speed loop by these factors
_SPEEDS = 160  # frequencies tried
_GRID = 700
_NOTCHES = ((0.4, 0.1), (0.8, 0.1), (1.4, 0.3))  # width, depth
STEP_TIME = 1.0  #: of a step on the twin [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaped:
    """A loop, what it does on the model, and its notch: frequency [Hz], width, depth."""

    loop: Loop
    step: StepMetrics
    notch: tuple[float, float, float] | None = None


def peak_of(plant: ServoPlant) -> float | None:
    """Return the frequency of the resonance [Hz], seen from the motor; None for one stiff mass."""
    if plant.stiffness is None:
        return None
    return math.sqrt(plant.stiffness * (1.0 / plant.motor_inertia + 1.0 / plant.load_inertia)) / (2.0 * math.pi)


def grid(plant: ServoPlant, period: float) -> Array:
    """Return frequencies [Hz] up to half the sampling's, denser around the resonance."""
    top = 0.4995 / period
    whole = np.geomspace(top * 1e-4, top, _GRID)
    peak = peak_of(plant)
    if peak is None or peak > 0.9 * top:
        return whole
    return np.unique(np.concatenate([whole, np.geomspace(peak * 0.8, min(peak * 1.25, top), _GRID // 2)]))


def cascade(
    plant: ServoPlant, w: float, period: float, *, filters: tuple[Biquad, ...] = (), limit: float = math.inf,
    averaged: int = 1,
) -> Loop:  # fmt: skip
    """Return the loop of a speed crossover w [rad/s], with the feed-forward of the plant's inverse dynamics.

    Raises
    ------
    ConfigError
        For an amplifier that closes the speed itself.
    """
    amplifier = plant.amplifier
    if amplifier.mode is Mode.SPEED:
        raise ConfigError("the amplifier closes the speed itself: that loop cannot be shaped", key="amplifier.mode",
                          hint="Tune it at the amplifier, and the position by --bandwidth of a model.")  # fmt: skip
    per = amplifier.gain * plant.torque_constant / (plant.resistance if amplifier.mode is Mode.VOLTAGE else 1.0)
    inertia = (plant.motor_inertia + plant.load_inertia) / per
    loop = Loop(
        period=period, position=Pid(kp=w / POSITION),
        speed=Pid(kp=inertia * w, ki=inertia * w * w / INTEGRAL, limit=limit),
        limit=limit, filters=filters, averaged=averaged,
    )  # fmt: skip
    return feed_forward(plant, loop)


def shape(
    plant: ServoPlant, period: float, *, most_ms: float = MS, limit: float = math.inf, size: float = 0.1
) -> Shaped:
    """Return the loop for an axis.

    Parameters
    ----------
    plant
        The model, its amplifier one of current or of voltage.
    most_ms
        Greatest sensitivity allowed.
    limit
        Of the command.
    size
        Of the step by which loops are compared.

    Raises
    ------
    LimitError
        When no loop of this shape keeps the margin.
    """
    frequency = grid(plant, period)
    body = plant_response(plant, frequency, period)
    found: list[Shaped] = []
    for shaped in _notches(plant, period):
        filters = () if shaped is None else (notch(shaped[0], period, width=shaped[1], depth=shaped[2]),)
        w = _fastest(plant, (period, frequency, body), filters, most_ms)
        if w is not None:
            loop = cascade(plant, w, period, filters=filters, limit=limit)
            found.append(Shaped(loop=loop, step=step_on_twin(plant, loop, size), notch=shaped))
    if not found:
        raise LimitError(f"no cascade keeps Ms below {most_ms:g} on this axis",
                         hint="Allow more, sample faster, or stiffen the drive train.")  # fmt: skip
    return min(found, key=lambda one: (one.step.settling, one.step.overshoot))


def _notches(plant: ServoPlant, period: float) -> list[tuple[float, float, float] | None]:
    """Return the notches to try; None: none."""
    peak = peak_of(plant)
    if peak is None or peak * period > 0.45:
        return [None]
    return [None, *((peak, width, depth) for width, depth in _NOTCHES)]


def _fastest(
    plant: ServoPlant, seen: tuple[float, Array, Response], filters: tuple[Biquad, ...], most_ms: float
) -> float | None:
    """Return the highest crossover [rad/s] with which the loop is stable and keeps Ms; None where none does.

    ``seen`` is the plant's response: period, frequencies, values.
    """
    period, frequency, body = seen
    for w in np.geomspace(1.0 / period, 1e-3 / period, _SPEEDS):
        loop = cascade(plant, float(w), period, filters=filters)
        sensitivity = np.abs(1.0 / (1.0 + controller_response(loop, frequency) * body)).max()
        if sensitivity <= most_ms and is_stable(plant, loop):
            return float(w)
    return None


def step_on_twin(plant: ServoPlant, loop: Loop, size: float, *, duration: float = STEP_TIME) -> StepMetrics:
    """Return the metrics of a step on the twin, without the feed-forward (which a step has none of)."""
    ticks = round(duration / loop.period)
    wanted = np.zeros((ticks, 3))
    wanted[:, 0] = size
    try:
        # an exact encoder: the metrics are those of the loop, not of one count
        samples = ServoAxis(replace(plant, counts=None), loop, step=2e-5).run(wanted)
    except LimitError:
        return StepMetrics(rise=math.inf, settling=math.inf, overshoot=math.inf, error=math.inf)
    return step_metrics(loop.period * np.arange(ticks, dtype=np.float64), samples.measured, size)
