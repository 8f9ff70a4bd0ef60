"""How far a joint is from where its transmission says, by place.  In: measured points.  Out: error and slopes anywhere.

Between points it is a natural cubic spline, and beyond them a straight line, so that error, slope and curvature are
continuous everywhere: nothing that follows it has to jump.  Legend: e error, ' derivative by place.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from trochia import units
from trochia.errors import ConfigError
from trochia.machine.codecs import Quantity

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

STEEPEST = 0.02  #: slope of an error: 20 µm a mm is a wrong lead, no error of a screw
MOST_POINTS = 1000
_LENGTH = Quantity("length", motion=True)
_PAIR = 2


class _Spline(NamedTuple):
    """Points (n,), errors (n,), curvatures at the points (n,)."""

    x: NDArray[np.float64]
    e: NDArray[np.float64]
    m: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorTable:
    """Error by place.

    Attributes
    ----------
    points
        Pairs of place and error [mm or degree]: how far the joint is beyond where it is told to be; places rise.

    Raises
    ------
    ConfigError
        At construction, for fewer than two points, places that do not rise, or an error that is steeper than 0.02.
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if not 2 <= len(self.points) <= MOST_POINTS:
            raise ConfigError(
                f"a table of errors has 2 to {MOST_POINTS} pairs of place and error, not {len(self.points)}"
            )
        if not all(math.isfinite(value) for pair in self.points for value in pair):
            raise ConfigError("places and errors are numbers")
        for (low, one), (high, other) in itertools.pairwise(self.points):
            if not high > low:
                raise ConfigError(f"places must rise: {high:g} stands behind {low:g}")
            if abs(other - one) > STEEPEST * (high - low):
                raise ConfigError(
                    f"from {low:g} to {high:g} the error changes by {other - one:g}, more than {STEEPEST:g} of the way",
                    hint="Is it in the right unit?  A wrong lead is mended in the transmission.",
                )

    @property
    def _spline(self) -> _Spline:
        return _natural(self.points)

    def at(self, place: ArrayLike) -> NDArray[np.float64]:
        """Return the error at places (n,) [mm or degree]."""
        x, e, m = self._spline
        at = np.asarray(place, np.float64)
        k = np.clip(x.searchsorted(at, side="right") - 1, 0, len(x) - 2)
        h = x[k + 1] - x[k]
        inside = np.clip(at, x[0], x[-1])
        a, b = (x[k + 1] - inside) / h, (inside - x[k]) / h
        bent = ((a**3 - a) * m[k] + (b**3 - b) * m[k + 1]) * h * h / 6.0
        return a * e[k] + b * e[k + 1] + bent + (at - inside) * self.slope(inside)

    def slope(self, place: ArrayLike) -> NDArray[np.float64]:
        """Return e' at places (n,)."""
        x, e, m = self._spline
        at = np.clip(np.asarray(place, np.float64), x[0], x[-1])
        k = np.clip(x.searchsorted(at, side="right") - 1, 0, len(x) - 2)
        h = x[k + 1] - x[k]
        a, b = (x[k + 1] - at) / h, (at - x[k]) / h
        return (e[k + 1] - e[k]) / h + ((3 * b * b - 1) * m[k + 1] - (3 * a * a - 1) * m[k]) * h / 6.0

    @property
    def steepest(self) -> tuple[float, float, float]:
        """Greatest |e'|, |e''| [1/mm], |e'''| [1/mm²] there are."""
        x, _, m = self._spline
        h = np.diff(x)
        turning = x[:-1] + h * np.clip(m[:-1] / np.where(m[:-1] == m[1:], np.inf, m[:-1] - m[1:]), 0.0, 1.0)  # e'' = 0
        slopes = np.abs(self.slope(np.concatenate([x, turning])))
        return float(slopes.max()), float(np.abs(m).max()), float(np.abs(np.diff(m) / h).max())


@lru_cache(maxsize=64)
def _natural(points: tuple[tuple[float, float], ...]) -> _Spline:
    """Return the natural cubic spline of points: curvature 0 at its ends."""
    x, e = np.array(points).T
    m = np.zeros(len(x))
    h, chord = np.diff(x), np.diff(e) / np.diff(x)
    if len(x) > _PAIR:
        system = np.diag(2.0 * (h[:-1] + h[1:])) + np.diag(h[1:-1], 1) + np.diag(h[1:-1], -1)
        m[1:-1] = np.linalg.solve(system, 6.0 * np.diff(chord))
    return _Spline(x, e, m)


@dataclass(frozen=True, slots=True)
class TableOfErrors:
    """How a table stands in a machine file: a list of pairs, ``[["0 mm", "0 mm"], ["50 mm", "8 um"], …]``."""

    def read(self, value: object, *, rotary: bool) -> ErrorTable:
        """Return the table; ConfigError where it is no list of pairs, UnitError where a unit is wrong."""
        rows = cast("list[object]", value) if isinstance(value, list) else [None]
        pairs = [cast("list[object]", row) for row in rows if isinstance(row, list)]
        if len(pairs) < len(rows) or any(len(pair) != _PAIR for pair in pairs):
            raise ConfigError(f"expected pairs like {self.example(rotary=rotary)}, not {units.shown(value)}")
        return ErrorTable(
            points=tuple((_LENGTH.read(x, rotary=rotary), _LENGTH.read(e, rotary=rotary)) for x, e in pairs)
        )

    def write(self, value: ErrorTable, *, rotary: bool) -> str:
        """Return the list of pairs."""
        pairs = (f"[{_LENGTH.write(x, rotary=rotary)}, {_LENGTH.write(e, rotary=rotary)}]" for x, e in value.points)
        return f"[{', '.join(pairs)}]"

    def example(self, *, rotary: bool) -> str:
        """Return a short one."""
        return self.write(ErrorTable(points=((0.0, 0.0), (100.0, 0.01))), rotary=rotary)
