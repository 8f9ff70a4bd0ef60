"""The circle test: where a machine that was told to go round a circle went.

In: a recording of two axes on a circle.  Out: the figures of ISO 230-4, and the spikes where an axis reverses.

    circular deviation G   greatest less least radius about the centre that fits the actual path best
    radial deviation F     actual radius about the commanded centre, less the commanded radius: greatest and least

A servo whose lag is that of a first-order loop of gain kv shrinks the circle to R / √(1 + (v / R kv)²); loops of unlike
gain make it an ellipse at 45 degrees; friction and backlash leave a spike at each quadrant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from trochia.errors import LimitError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.recorder import Recording

    Floats = NDArray[np.float64]

ROUND = 1e-3  #: part of the radius by which a command may leave its circle and still be on it
WIDE = math.radians(20)  #: after a reversal, in which its spike is looked for
BASE = math.radians(10)  #: before it, of which the mean is what the spike stands on


@dataclass(frozen=True, slots=True)
class Spike:
    """A reversal: at which angle [degree], and how far it stands out [mm], outwards above zero."""

    angle: float
    height: float


@dataclass(frozen=True, slots=True, kw_only=True)
class CircleTest:
    """What the circle became.

    Attributes
    ----------
    centre, radius
        As commanded [mm].
    angle, deviation
        Of every sample on the circle: angle as commanded [rad], and actual radius less the commanded one [mm] (n,).
    circular_deviation
        G [mm].
    radial_deviation
        F, least and greatest [mm].
    actual_centre, actual_radius
        Of the circle that fits the actual path best [mm].
    spikes
        One for each reversal of an axis.
    """

    centre: tuple[float, float]
    radius: float
    angle: Floats
    deviation: Floats
    circular_deviation: float
    radial_deviation: tuple[float, float]
    actual_centre: tuple[float, float]
    actual_radius: float
    spikes: tuple[Spike, ...]

    def figures(self) -> dict[str, object]:
        """Return the figures for people and scripts [mm, degree]."""
        return {
            "radius_mm": self.radius, "circular_deviation_mm": self.circular_deviation,
            "radial_deviation_mm": list(self.radial_deviation), "actual_radius_mm": self.actual_radius,
            "spikes": [{"angle_deg": spike.angle, "height_mm": spike.height} for spike in self.spikes],
        }  # fmt: skip


def circle_test(recording: Recording, axes: tuple[str, str] = ("X", "Y")) -> CircleTest:
    """Return what became of the longest circle that two axes were told to go round.

    Raises
    ------
    LimitError
        When there is no such circle of at least a whole turn.
    """
    told = np.stack([recording[f"{axis}.commanded"][:] for axis in axes], axis=1)
    was = np.stack([recording[f"{axis}.actual"][:] for axis in axes], axis=1)
    span, centre, radius = _circle(told, recording.period, axes)
    told, was = told[span], was[span]
    angle = np.unwrap(np.arctan2(*(told - centre).T[::-1]))
    deviation = np.hypot(*(was - centre).T) - radius
    middle, mean = fit_circle(was)
    spread = np.hypot(*(was - middle).T)
    return CircleTest(
        centre=(float(centre[0]), float(centre[1])), radius=radius, angle=angle, deviation=deviation,
        circular_deviation=float(np.ptp(spread)), radial_deviation=(float(deviation.min()), float(deviation.max())),
        actual_centre=(float(middle[0]), float(middle[1])), actual_radius=mean, spikes=_spikes(angle, deviation),
    )  # fmt: skip


def fit_circle(points: Floats) -> tuple[Floats, float]:
    """Return the centre (2,) and radius of the circle that fits points (n, 2) best, by Kåsa's linear least squares."""
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    found = np.linalg.lstsq(np.stack([x, y, np.ones(len(x))], axis=1), x * x + y * y, rcond=None)[0]
    centre = 0.5 * found[:2]
    return centre + middle, float(np.sqrt(found[2] + centre @ centre))


def _circle(told: Floats, period: float, axes: tuple[str, str]) -> tuple[slice, Floats, float]:
    """Return the longest span of the command on one circle, with its centre and radius."""
    curvature, steps = _curvature(told)
    bent = np.isfinite(curvature) & (np.abs(curvature) > 1e-6)
    level = np.where(bent, curvature, 0.0)
    # a new stretch wherever the curvature is another, by more than what a change of speed makes of it
    cuts = np.flatnonzero(np.abs(np.diff(level)) > 0.02 * np.abs(level[:-1]) + 1e-9) + 1
    edges = np.concatenate([[0], cuts, [len(level)]])
    best: tuple[float, slice, Floats, float] | None = None
    for begin, end in pairwise(edges.tolist()):
        turned = float(np.abs(level[begin:end] @ steps[begin:end]))
        if turned > (best[0] if best else 0.9 * math.tau):
            span = slice(begin + 1, end + 1)
            centre, radius = fit_circle(told[span])
            off = np.abs(np.hypot(*(told[span] - centre).T) - radius).max()
            if off < ROUND * radius:
                best = (turned, span, centre, radius)
    if best is None:
        raise LimitError(
            f"no whole circle of {axes[0]} and {axes[1]} in {len(told) * period:.3g} s of recording",
            hint="Record a program with a full circle, like G2 X0 Y0 I20 J0, at a steady feed.",
        )
    return best[1], best[2], best[3]


def _curvature(told: Floats) -> tuple[Floats, Floats]:
    """Return the curvature at inner samples (n - 2,) [1/mm], NaN at rest, and the way from one to the next [mm]."""
    before, after = told[1:-1] - told[:-2], told[2:] - told[1:-1]
    steps = np.hypot(*after.T)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    chord = np.hypot(*(before + after).T)
    product = np.hypot(*before.T) * steps * chord
    moving = product > 1e-18
    return np.where(moving, 2 * cross / np.where(moving, product, 1.0), np.nan), steps


def _spikes(angle: Floats, deviation: Floats) -> tuple[Spike, ...]:
    """Return the spike behind each multiple of 90 degrees that the command passes."""
    way = 1.0 if angle[-1] > angle[0] else -1.0
    turned = way * angle
    quarter = math.pi / 2
    first, last = math.ceil((turned[0] + BASE) / quarter), math.floor((turned[-1] - WIDE) / quarter)
    found: list[Spike] = []
    for number in range(first, last + 1):
        at = number * quarter
        base = deviation[(turned > at - BASE) & (turned < at)]
        there = deviation[(turned >= at) & (turned < at + WIDE)]
        if base.size and there.size:
            stand = there - base.mean()
            height = float(stand[np.argmax(np.abs(stand))])
            found.append(Spike(math.degrees(way * at) % 360, height))
    return tuple(found)
