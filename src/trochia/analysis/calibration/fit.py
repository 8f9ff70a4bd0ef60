"""What measured points say of an axis.  In: points.  Out: scale, error by place, backlash, each with its uncertainty.

Legend: d = measured - commanded; at a place the mean of d from both ways is the error of the screw, half of their
difference is half the backlash (the load lags behind its motor).  The scale is the slope of a line through the errors.
Uncertainties are expanded (k = 2): twice the standard deviation of a mean, from how points repeat and from the
instrument's resolution r, r / sqrt(12) (JCGM 100:2008, 4.3.7).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.calibration.points import Points

SAME = 1e-6  #: commanded places that are one [mm or degree]
_COVER = 2.0  #: k


@dataclass(frozen=True, slots=True)
class Spot:
    """A place, the error there and its uncertainty [mm or degree]."""

    place: float
    error: float
    sure: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What points say.

    Attributes
    ----------
    spots
        Error by place, 0 where ``reference`` is.
    scale
        (error of the scale as a part, its uncertainty): 1e-4 is 0.1 mm too far in a metre.
    backlash
        (value, its uncertainty) [mm or degree]; None where no place was come to from both ways.
    repeatability
        Standard deviation of one measurement [mm or degree]; None where nothing was measured twice.
    """

    spots: tuple[Spot, ...]
    scale: tuple[float, float]
    backlash: tuple[float, float] | None
    repeatability: float | None
    reference: float


def fit(points: Points, *, resolution: float = 0.0) -> Found:
    """Return what points say; ``resolution`` of the instrument [mm or degree]."""
    apart = points.measured - points.commanded
    order = np.argsort(points.commanded, kind="stable")
    cuts = np.flatnonzero(np.diff(points.commanded[order]) > SAME) + 1
    groups = np.split(order, cuts)
    places = np.array([points.commanded[group].mean() for group in groups])
    sigma = _repeatability(apart, points.ways, groups)
    spread = sigma or 0.0
    step = resolution / math.sqrt(12.0)
    errors, sures, lags = np.zeros(len(groups)), np.zeros(len(groups)), []
    for k, group in enumerate(groups):
        sides = [apart[group[points.ways[group] == way]] for way in (1, -1)]
        if all(side.size for side in sides):
            errors[k] = 0.5 * (sides[0].mean() + sides[1].mean())
            lags.append(float(sides[1].mean() - sides[0].mean()))
        else:
            errors[k] = apart[group].mean()
        sures[k] = _COVER * math.sqrt(spread**2 / len(group) + step**2)
    if lags:  # a place that was come to from one way only has half of it in its error
        for k, group in enumerate(groups):
            ways = set(points.ways[group].tolist()) - {0}
            if len(ways) == 1:
                errors[k] += 0.5 * float(np.mean(lags)) * next(iter(ways))
    zero = int(np.argmin(np.abs(places)))
    spots = tuple(Spot(float(x), float(e - errors[zero]), float(u))
                  for x, e, u in zip(places, errors, sures, strict=True))  # fmt: skip
    return Found(spots=spots, scale=_slope(places, errors, sures), backlash=_backlash(lags, step),
                 repeatability=sigma, reference=float(places[zero]))  # fmt: skip


def _repeatability(apart: NDArray[np.float64], ways: NDArray[np.int8], groups: list[NDArray[np.intp]]) -> float | None:
    """Return the pooled standard deviation of points of one place and way; None where each stands alone."""
    total, freedom = 0.0, 0
    for group in groups:
        for way in (-1, 0, 1):
            same = apart[group[ways[group] == way]]
            if same.size > 1:
                total += float(((same - same.mean()) ** 2).sum())
                freedom += same.size - 1
    return math.sqrt(total / freedom) if freedom else None


def _slope(places: NDArray[np.float64], errors: NDArray[np.float64], sures: NDArray[np.float64]) -> tuple[float, float]:
    """Return the slope of the line of least squares, and its uncertainty: the greater of scatter and knowledge."""
    if len(places) == 1:
        return 0.0, math.inf
    centred = places - places.mean()
    weight = float(centred @ centred)
    slope = float(centred @ errors) / weight
    left = errors - errors.mean() - slope * centred
    known = float(np.mean(sures))
    scatter = _COVER * math.sqrt(float(left @ left) / (len(places) - 2)) if len(places) > 2 else 0.0
    return slope, max(known, scatter) / math.sqrt(weight)


def _backlash(lags: list[float], step: float) -> tuple[float, float] | None:
    if not lags:
        return None
    scatter = float(np.std(lags, ddof=1)) / math.sqrt(len(lags)) if len(lags) > 1 else 0.0
    return float(np.mean(lags)), _COVER * math.hypot(scatter, step * math.sqrt(2.0 / len(lags)))
