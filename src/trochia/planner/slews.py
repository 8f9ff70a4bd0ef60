"""How fast a trajectory's time may change.  In: phases of a trajectory.  Out: the slews each allows, and stops.

At rate r = du/dt between 0 and 1 (see ``timebase.py``) every limit holds in a phase as long as slowing |r'|, quickening
r' and |r''| stay below the three numbers of the phase: these are what a backend that changes its time by itself needs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel
from trochia.planner.ramp import ramp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.planner.limits import Limits
    from trochia.planner.timebase import TimeBase

#: of each phase: when it begins and how long it lasts by the trajectory's own time; greatest -r', r' and |r''|
SLEW = np.dtype([("u", "f8"), ("duration", "f8"), ("slow", "f8"), ("quick", "f8"), ("twist", "f8")])
_INTERVALS = 12
_RESERVE = 1.0 - 1e-3  #: for what the limited quantities do between the instants that are looked at
_SHARE = 0.5  #: of the jerk that is left goes to changes of time at speed, the rest to changes of the slew
_MOST = 1e6  #: per second: where nothing moves, time may change as it likes
_DROPS = (0.0, 0.25, 0.5, 0.75, 0.9)  #: parts of a rate that a stop tries to go down to at once


def slews(
    segments: NDArray[Any], pool: NDArray[np.float64], limits: Limits, phases: NDArray[Any], *, jerky: bool
) -> NDArray[Any]:
    """Return the greatest slews of each phase (k,) of :data:`SLEW`; ``jerky``: jerk is limited."""
    out = np.zeros(len(phases), dtype=SLEW)
    out["u"], out["duration"] = phases["t"], phases["duration"]
    first, second, third = (_quantities(segments, pool, limits, phases, order) for order in (1, 2, 3))
    size = np.abs(first)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        most = _least(_RESERVE * limits.acceleration / size, size)
        for name, sign in (("slow", -1.0), ("quick", 1.0)):
            # |q'' + sign q' r'| <= A at r = 1, |q' r'| <= A at r = 0; between them q'' r² + q' r' lies between both
            room = (_RESERVE * limits.acceleration - sign * np.sign(first) * second) / size
            out[name] = np.clip(np.minimum(_least(room, size), most), 0.0, _MOST)
        out["twist"] = _MOST
        if jerky:
            left = np.maximum(_RESERVE * limits.jerk - np.abs(third), 0.0)
            cross = _least(_SHARE * left / (3.0 * np.abs(second)), np.abs(second))
            out["slow"], out["quick"] = np.minimum(out["slow"], cross), np.minimum(out["quick"], cross)
            greatest = np.maximum(out["slow"], out["quick"])[:, None, None]
            out["twist"] = np.clip(_least((left - 3.0 * np.abs(second) * greatest) / size, size), 0.0, _MOST)
    return out


def _quantities(
    segments: NDArray[Any], pool: NDArray[np.float64], limits: Limits, phases: NDArray[Any], order: int
) -> NDArray[np.float64]:
    """Return the derivatives of the limited quantities (phases, instants, rows)."""
    states = np.repeat(phases, _INTERVALS + 1)
    tau = np.tile(np.linspace(0.0, 1.0, _INTERVALS + 1), len(phases)) * states["duration"]
    states["s"] += tau * (states["v"] + tau * (states["a"] / 2 + tau * states["j"] / 6))
    states["v"] += tau * (states["a"] + tau * states["j"] / 2)
    states["a"] += tau * states["j"]
    values = kernel.sample(segments, pool, limits.matrix.shape[1], states, order) @ limits.matrix.T
    return values.reshape(len(phases), _INTERVALS + 1, -1)


def _least(room: NDArray[np.float64], size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least room of each phase where there is something that moves (phases,)."""
    return np.where(size > 0.0, room, np.inf).min(axis=(1, 2))


def stop(rows: NDArray[Any], base: TimeBase, t: float) -> TimeBase:
    """Return the time base that comes to rest from ``t`` on inside the slews of all phases it passes.

    Its rate falls step by step: each change begins and ends with r' = 0 and uses the least slews of the phases it
    passes.  At an even rate below 1 every limit holds, so there is always a next instant to begin at, at last the end.
    """
    while base.at(t, 1)[0] > 0.0:
        (u,), (rate,) = base.at(t), base.at(t, 1)
        k = int(np.clip(np.searchsorted(rows["u"], u, side="right") - 1, 0, len(rows) - 1))
        if u >= rows["u"][-1] + rows["duration"][-1]:
            return base.slewed(t, 0.0, slew=_MOST)
        for part in _DROPS:
            bounds = _bounds(rows, k, float(u), (float(rate), part * float(rate) if rate > 0.02 else 0.0))
            if bounds is not None:
                goal = part * float(rate) if rate > 0.02 else 0.0
                base = base.slewed(t, goal, slew=bounds[0], twist=bounds[1])
                t = float(base.t[-1])
                break
        else:
            t += float(rows["u"][k] + rows["duration"][k] - u) / float(rate) + 1e-9
    return base


def _bounds(rows: NDArray[Any], k: int, u: float, rates: tuple[float, float]) -> tuple[float, float] | None:
    """Return slew and twist of a change between two rates that every phase it passes allows; None: there is none."""
    end = k
    while True:
        slew, twist = float(rows["slow"][k : end + 1].min()), float(rows["twist"][k : end + 1].min())
        if not (slew > 0.0 and twist > 0.0):
            return None
        way = sum(piece.way for piece in ramp((rates[0], 0.0), (rates[1], 0.0), slew, twist))
        last = int(np.searchsorted(rows["u"], u + way, side="right")) - 1
        if last <= end:
            return slew, twist
        end = last
