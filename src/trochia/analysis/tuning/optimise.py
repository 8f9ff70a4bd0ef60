"""The search by differential evolution: the loop that settles first on the twin, inside bounds of robustness.

In: a model of the axis, bounds on Ms, gain and phase margin.  Out: a Loop.  What is sought: the speed loop's crossover,
its integral and the position gain relative to it, width and depth of a notch at the peak.  Candidates that break a
bound are never run on the twin; they are rated by how far they break it, which leads the search back inside.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.analysis.tuning.margins import is_stable
from trochia.analysis.tuning.shaping import INTEGRAL, POSITION, Shaped, cascade, grid, peak_of, shape, step_on_twin
from trochia.errors import LimitError
from trochia.servo.filters import notch
from trochia.servo.sampled import controller_response, plant_response

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]
    Response = NDArray[np.complex128]

_BROKEN = 1e3  # rating of what breaks a bound: above any settling time


@dataclass(frozen=True, slots=True, kw_only=True)
class Robustness:
    """Bounds: Ms at most, gain margin and phase margin [degree] at least."""

    ms: float = 1.6
    gm: float = 2.0
    pm_deg: float = 30.0


def optimise(
    plant: ServoPlant, period: float, *, bounds: Robustness | None = None, limit: float = math.inf, size: float = 0.1,
    generations: int = 15, people: int = 8, seed: int = 1,
) -> Shaped:  # fmt: skip
    """Return the best loop found; never one worse than loop shaping gives.

    Raises
    ------
    LimitError
        When no loop keeps the bounds.
    """
    from scipy.optimize import differential_evolution  # noqa: PLC0415 - scipy is slow to import

    kept = bounds or Robustness()
    start = shape(plant, period, most_ms=kept.ms, limit=limit, size=size)
    frequency = grid(plant, period)
    body = plant_response(plant, frequency, period)
    w = start.loop.position.kp * POSITION if start.loop.position is not None else 1.0

    def rating(x: Array) -> float:
        loop = _loop(plant, period, w, x, limit)
        broken = breach(controller_response(loop, frequency) * body, kept)
        if broken > 0.0:
            return _BROKEN * (1.0 + broken)
        if not is_stable(plant, loop):
            return _BROKEN * 10.0
        step = step_on_twin(plant, loop, size, duration=0.5)
        return min(step.settling, 1.0) + 0.2 * max(step.overshoot - 0.05, 0.0) + 1e-3 * step.error

    spans = [(-0.7, 0.7), (-1.0, 1.0), (-0.7, 0.7), (-1.5, 0.7), (0.02, 1.0)]
    found = differential_evolution(
        rating,
        spans,
        x0=np.array([-0.01, 0.0, 0.0, -0.2, 0.9]),
        maxiter=generations,
        popsize=people // 2,
        rng=np.random.default_rng(seed),
        polish=False,
        tol=1e-6,
    )
    if found.fun >= _BROKEN:
        if breach(controller_response(start.loop, frequency) * body, kept) > 0.0:
            raise LimitError("no loop keeps these margins on this axis", hint="Allow a greater Ms, or smaller margins.")
        return start
    loop = _loop(plant, period, w, np.asarray(found.x, np.float64), limit)
    peak, width, depth = peak_of(plant), math.exp(float(found.x[3])), float(found.x[4])
    best = Shaped(loop=loop, step=step_on_twin(plant, loop, size),
                  notch=(peak, width, depth) if loop.filters and peak is not None else None)  # fmt: skip
    return min(start, best, key=lambda one: (one.step.settling, one.step.overshoot))


def _loop(plant: ServoPlant, period: float, w: float, x: Array, limit: float) -> Loop:
    """Return the loop of a candidate: logarithms of factors on w, integral, position gain, notch width; its depth."""
    speed, integral, position, width = np.exp(x[:4])
    peak = peak_of(plant)
    filters = ()
    if peak is not None and peak * period < 0.45:
        filters = (notch(peak, period, width=float(width), depth=float(x[4])),)
    loop = cascade(plant, float(w * speed), period, filters=filters, limit=limit)
    assert loop.speed is not None, "a cascade has a speed loop"
    assert loop.position is not None, "and a position loop"
    ki = loop.speed.kp * w * float(speed * integral) / INTEGRAL
    return replace(loop, speed=replace(loop.speed, ki=ki),
                   position=replace(loop.position, kp=loop.position.kp * float(position)))  # fmt: skip


def breach(whole: Response, kept: Robustness) -> float:
    """Return by how much a loop's response (lines,), rising in frequency, breaks the bounds; 0: not at all."""
    ms = float(np.abs(1.0 / (1.0 + whole)).max())
    size, phase = np.abs(whole), np.angle(whole)
    crossings = np.nonzero((size[:-1] >= 1.0) & (size[1:] < 1.0) | (size[:-1] < 1.0) & (size[1:] >= 1.0))[0]
    pm = math.degrees(float(np.abs(math.pi - np.abs(phase[crossings])).min())) if len(crossings) else math.inf
    turns = np.nonzero((np.diff(np.sign(whole.imag)) != 0) & (whole.real[:-1] < 0.0) & (size[:-1] < 1.0))[0]
    gm = float((1.0 / size[turns]).min()) if len(turns) else math.inf
    return max(ms / kept.ms - 1.0, 0.0) + max(1.0 - gm / kept.gm, 0.0) + max(1.0 - pm / kept.pm_deg, 0.0)
