"""The comparison of the classic interpolators: precision, evenness of the pulses, cost.

In: a method and a figure.  Out: its ``Merit``, from the pulses the C core makes.

Legend: t tick of a pulse, s way along the true curve of the point nearest to where the axes then stand; uniform motion
would have s grow by v for every tick.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trochia.pulses.interpolators import positions
from trochia.pulses.interpolators.counting import operations_per_step
from trochia.pulses.interpolators.frame import Arc, Figure, Line

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.pulses.interpolators import Interpolator

_TICKS = 400_000  # of a timing run: some ms, long enough for the clock, short enough to wait for


@dataclass(frozen=True, slots=True, kw_only=True)
class Merit:
    """What one method makes of a figure.

    Attributes
    ----------
    ticks, steps_x, steps_y
        Ticks to the end, and steps of each axis.
    end
        Where it ends [steps].
    deviation_max, deviation_rms
        Distance from the true curve, over the points the axes stand on [steps].
    jitter_max, jitter_rms
        By how much an interval between two pulses differs from what uniform motion along the curve asks, in shares of
        the mean interval.
    ns_per_step
        Time of the C core for a step of one axis [ns]; None when it was not measured.
    operations
        Additions, comparisons and shifts (``simple``), ``products`` and ``quotients`` for a step of one axis.
    """

    name: str
    title: str
    ticks: int
    steps_x: int
    steps_y: int
    end: tuple[int, int]
    deviation_max: float
    deviation_rms: float
    jitter_max: float
    jitter_rms: float
    ns_per_step: float | None
    operations: dict[str, float]


def start_of(figure: Figure) -> tuple[int, int]:
    """Return where a figure begins: a line at (0, 0), an arc on its circle about (0, 0) [steps]."""
    return figure.start if isinstance(figure, Arc) else (0, 0)


def end_of(figure: Figure) -> tuple[int, int]:
    """Return where a figure ends [steps]."""
    return figure.end if isinstance(figure, Arc) else (figure.x, figure.y)


def deviations(figure: Figure, points: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the signed distance of points (n, 2) from the true curve (n,): left of the line, or outside [steps]."""
    if isinstance(figure, Line):
        return (points[:, 1] * figure.x - points[:, 0] * figure.y) / figure.length
    return np.hypot(points[:, 0], points[:, 1]) - figure.radius


def way_along(figure: Figure, points: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the way along the true curve to the point nearest to each of points (n, 2), in order (n,) [steps]."""
    if isinstance(figure, Line):
        return (points[:, 0] * figure.x + points[:, 1] * figure.y) / figure.length
    angles = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    return figure.radius * (angles[0] - angles if figure.clockwise else angles - angles[0])


def pulse_ticks(pulses: NDArray[np.uint8]) -> NDArray[np.intp]:
    """Return the ticks, from 1, at which any axis steps."""
    return np.flatnonzero(pulses & 0b1100) + 1


def interval_errors(figure: Figure, pulses: NDArray[np.uint8], points: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return each interval between two pulses less the uniform one (pulses - 1,), in shares of the mean interval."""
    ticks = pulse_ticks(pulses)
    way = way_along(figure, points)[ticks]
    if ticks.size < 2 or way[-1] <= way[0]:
        return np.zeros(1)
    speed = (way[-1] - way[0]) / (ticks[-1] - ticks[0])
    return (np.diff(ticks) - np.diff(way) / speed) / np.diff(ticks).mean()


def time_per_step(method: Interpolator, figure: Figure, ticks: int, steps: int) -> float:
    """Return the best of several runs of the C core [ns for a step of one axis]."""
    begun, times = method.begin(figure), max(1, _TICKS // max(ticks, 1))
    best = float("inf")
    for _ in range(5):
        start = time.perf_counter()
        begun.over(times)
        best = min(best, time.perf_counter() - start)
    return 1e9 * best / (times * max(steps, 1))


def merit(method: Interpolator, figure: Figure, *, timed: bool = True) -> Merit:
    """Return what a method makes of a figure; ``timed`` measures the C core too."""
    pulses = method.pulses(figure)
    points = positions(pulses, start_of(figure))
    stood = points[np.concatenate(([0], pulse_ticks(pulses)))]
    away = np.abs(deviations(figure, stood))
    errors = interval_errors(figure, pulses, points)
    steps_x, steps_y = (int(np.count_nonzero(pulses & bit)) for bit in (4, 8))
    return Merit(
        name=method.name,
        title=method.title,
        ticks=pulses.size,
        steps_x=steps_x,
        steps_y=steps_y,
        end=(int(points[-1, 0]), int(points[-1, 1])),
        deviation_max=float(away.max()),
        deviation_rms=float(np.sqrt(np.mean(away**2))),
        jitter_max=float(np.abs(errors).max()),
        jitter_rms=float(np.sqrt(np.mean(errors**2))),
        ns_per_step=time_per_step(method, figure, pulses.size, steps_x + steps_y) if timed else None,
        operations=operations_per_step(method, figure),
    )
