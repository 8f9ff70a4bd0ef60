"""How acceleration falls with speed: torque by speed over what a motor moves.  In: knots.  Out: limits at speeds.

Between knots it is a straight line; below the first knot the first holds, and nothing moves faster than the last.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from trochia import units
from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

_PAIR = 2
_PLACES = 16  #: a knot, where a function is looked at
_SPEED = Quantity("velocity", motion=True)
_ACCELERATION = Quantity("acceleration", motion=True)
MOST_KNOTS = 32  #: as many as ``core/host/plan_torque.h`` has room for


@dataclass(frozen=True, slots=True, kw_only=True)
class AccelerationCurve:
    """Greatest acceleration by speed.

    Attributes
    ----------
    knots
        Pairs of speed and acceleration [mm/s, mm/s² or degree/s, degree/s²]; speeds rise, accelerations do not.

    Raises
    ------
    ConfigError
        At construction, when they do.
    """

    knots: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.knots) <= MOST_KNOTS:
            raise ConfigError(f"a curve has 1 to {MOST_KNOTS} pairs of speed and acceleration, not {len(self.knots)}")
        for speed, acceleration in self.knots:
            if not (np.isfinite(speed) and speed >= 0.0 and np.isfinite(acceleration) and acceleration > 0.0):
                raise ConfigError(
                    f"speeds are zero or more and accelerations above zero, not {speed:g}, {acceleration:g}"
                )
        for (slow, more), (fast, less) in itertools.pairwise(self.knots):
            if not fast > slow:
                raise ConfigError(f"speeds must rise: {fast:g} stands behind {slow:g}")
            if less > more:
                raise ConfigError(
                    f"acceleration must not rise with speed: {less:g} at {fast:g} is above {more:g} at {slow:g}",
                    hint="Where a motor's torque dips, give the dip's value from there on.",
                )
        if not self.top > 0.0:
            raise ConfigError("the last speed is the greatest there is, above zero")

    @classmethod
    def of_torque(cls, speed: ArrayLike, torque: ArrayLike, load: ArrayLike, inertia: float) -> AccelerationCurve:
        """Return (T - TL) / J at each speed, held down where it would rise, up to where it is no longer above zero.

        That is T = TL + J dv/dt, solved for dv/dt.  Units are whatever makes ``torque / inertia`` an acceleration in
        the unit of ``speed``.

        Raises
        ------
        ConfigError
            When nothing is left at the first speed.
        """
        at = np.atleast_1d(np.asarray(speed, dtype=np.float64))
        rest = np.minimum.accumulate(
            (np.asarray(torque, np.float64) - np.asarray(load, np.float64)) / inertia + 0.0 * at
        )
        kept = rest > 0.0
        if not kept.any():
            raise ConfigError("the motor's torque does not exceed the load at any speed")
        return cls(knots=tuple(zip(at[kept].tolist(), rest[kept].tolist(), strict=True)))

    @classmethod
    def below(cls, function: Callable[[NDArray[np.float64]], NDArray[np.float64]], top: float) -> AccelerationCurve:
        """Return a curve up to speed ``top`` that is nowhere above a function of speed, seen at sixteen places a knot.

        Raises
        ------
        ConfigError
            When the function is not above zero.
        """
        speeds = np.linspace(0.0, top, MOST_KNOTS)
        seen = np.linspace(0.0, top, _PLACES * (MOST_KNOTS - 1) + 1)
        values = np.minimum.accumulate(np.asarray(function(seen), dtype=np.float64))
        knots = values[::_PLACES]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.nan_to_num(values / np.interp(seen, speeds, knots), nan=0.0)
        part = np.append(share[:-1].reshape(-1, _PLACES).min(axis=1), 1.0)  # of the stretch behind each knot
        knots = np.minimum.accumulate(knots * np.minimum(part, np.append(1.0, part[:-1])))
        return cls(knots=tuple(zip(speeds.tolist(), knots.tolist(), strict=True)))

    @property
    def top(self) -> float:
        """Speed of the last knot: the greatest there is [mm/s or degree/s]."""
        return self.knots[-1][0]

    def at(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Return the greatest acceleration at each |speed|, the last knot's beyond it [mm/s² or degree/s²]."""
        speeds, values = np.array(self.knots).T
        return np.interp(np.abs(np.asarray(speed, dtype=np.float64)), speeds, values)

    def time(self, speed: float) -> float:
        """Return how long it takes from rest to ``speed``, up to the last knot: the integral of dv / A(v) [s]."""
        total, knots = 0.0, ((0.0, self.knots[0][1]), *self.knots)
        for (v0, a0), (v1, a1) in itertools.pairwise(knots):
            end = min(v1, speed)
            if end <= v0:
                continue
            last = a0 + (a1 - a0) * (end - v0) / (v1 - v0)
            # the mean of 1/A over a straight line is ln(a0 / a1) / (a0 - a1)
            drop = (a0 - last) / a0
            total += (end - v0) / a0 * (-np.log1p(-drop) / drop if drop > 1e-9 else 1.0 + drop / 2)
        return float(total)

    def least(self, other: AccelerationCurve) -> AccelerationCurve:
        """Return a curve that is nowhere above either: the lesser at all knots of both and where they cross."""
        top = min(self.top, other.top)
        speeds = sorted({v for v, _ in (*self.knots, *other.knots) if v <= top} | {0.0})
        for v0, v1 in itertools.pairwise(tuple(speeds)):
            d0, d1 = (float(self.at(v) - other.at(v)) for v in (v0, v1))
            if d0 * d1 < 0.0:
                speeds.append(v0 + (v1 - v0) * d0 / (d0 - d1))
        knots = [(v, min(float(self.at(v)), float(other.at(v)))) for v in sorted(speeds)]
        falling = np.minimum.accumulate([a for _, a in knots]).tolist()  # rounding at a crossing must not make it rise
        return AccelerationCurve(knots=tuple((v, a) for (v, _), a in zip(knots, falling, strict=True))[:MOST_KNOTS])

    def capped(self, acceleration: float) -> AccelerationCurve:
        """Return the lesser of the curve and a constant."""
        return self.least(AccelerationCurve(knots=((self.top, acceleration),)))


@dataclass(frozen=True, slots=True)
class CurveOfAcceleration:
    """How a curve stands in a machine file: a list of pairs, ``[["0 mm/s", "2000 mm/s²"], …]``."""

    def read(self, value: object, *, rotary: bool) -> AccelerationCurve:
        """Return the curve; ConfigError where it is no list of pairs, UnitError where a unit is wrong."""
        rows = cast("list[object]", value) if isinstance(value, list) else [None]
        pairs = [cast("list[object]", row) for row in rows if isinstance(row, list)]
        if len(pairs) < len(rows) or any(len(pair) != _PAIR for pair in pairs):
            raise ConfigError(f"expected pairs like {self.example(rotary=rotary)}, not {units.shown(value)}")
        return AccelerationCurve(
            knots=tuple((_SPEED.read(v, rotary=rotary), _ACCELERATION.read(a, rotary=rotary)) for v, a in pairs)
        )

    def write(self, value: AccelerationCurve, *, rotary: bool) -> str:
        """Return the list of pairs."""
        pairs = (f"[{_SPEED.write(v, rotary=rotary)}, {_ACCELERATION.write(a, rotary=rotary)}]"
                 for v, a in value.knots)  # fmt: skip
        return f"[{', '.join(pairs)}]"

    def example(self, *, rotary: bool) -> str:
        """Return a falling one."""
        return self.write(AccelerationCurve(knots=((10.0, 200.0), (100.0, 50.0))), rotary=rotary)
