"""How far a loop is from instability: gain margin, phase margin, Ms.

In: the frequency response of the loop cut open.  Out: :class:`Margins`, by python-control.  Ms is the greatest
magnitude of the sensitivity 1 / (1 + L): 1 / Ms is how near L comes to -1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.servo.sampled import closed_poles, open_loop

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]
    Response = NDArray[np.complex128]

POINTS = 1500  #: frequencies of a search


@dataclass(frozen=True, slots=True, kw_only=True)
class Margins:
    """Of one loop.

    Attributes
    ----------
    gm
        Factor by which the gain may grow; infinity: any.
    pm_deg
        Phase that may be lost at the crossover [degree]; infinity: there is no crossover.
    ms
        Greatest magnitude of the sensitivity.
    crossover
        Frequency at which the gain is 1 [rad/s]; 0: none.
    stable
        Whether the closed loop is.
    """

    gm: float
    pm_deg: float
    ms: float
    crossover: float
    stable: bool = True

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints; what has no number is null."""
        return {name: value if math.isfinite(value) else None
                for name, value in (("gm", self.gm), ("pm_deg", self.pm_deg), ("ms", self.ms))}  # fmt: skip


def margins_of(response: Callable[[Array], Response], low: float, high: float, *, stable: bool = True) -> Margins:
    """Return the margins of L(w), w between two frequencies [rad/s].

    Margins with several crossings are the smallest.
    """
    import control  # noqa: PLC0415 - slow to import

    w = np.geomspace(low, high, POINTS)
    values = response(w)
    # where it crosses or comes near -1 a finer grid, so that the interpolation of python-control is exact enough
    near = w[int(np.argmin(np.abs(1.0 + values)))]
    w = np.unique(np.concatenate([w, np.geomspace(max(near / 1.1, low), min(near * 1.1, high), POINTS // 3)]))
    values = response(w)
    data = control.frd(values, w, smooth=True)
    gm, pm, _, _, crossover, _ = control.stability_margins(data)
    finer = float(np.abs(1.0 / (1.0 + values)).max())
    return Margins(
        gm=float(gm) if gm is not None and np.isfinite(gm) else math.inf,
        pm_deg=float(pm) if pm is not None and np.isfinite(pm) else math.inf,
        ms=finer, crossover=float(crossover) if crossover is not None and np.isfinite(crossover) else 0.0,
        stable=stable,
    )  # fmt: skip


def loop_margins(plant: ServoPlant, loop: Loop) -> Margins:
    """Return the margins of a sampled loop around the linear part of a plant."""
    top = math.pi / loop.period
    return margins_of(
        lambda w: open_loop(plant, loop, w / (2.0 * math.pi)), top * 1e-5, top * 0.999, stable=is_stable(plant, loop)
    )


def is_stable(plant: ServoPlant, loop: Loop) -> bool:
    """Whether all poles of the closed loop are inside the unit circle."""
    return bool(np.abs(closed_poles(plant, loop)).max() < 1.0)


def greatest_sensitivity(plant: ServoPlant, loop: Loop, frequency: Array) -> float:
    """Return Ms over frequencies [Hz]; quick, for searches."""
    return float(np.abs(1.0 / (1.0 + open_loop(plant, loop, frequency))).max())
