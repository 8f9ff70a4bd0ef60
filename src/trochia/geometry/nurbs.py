"""Rational B-splines in the plane, Bezier curves among them.

In: weighted control points and the order.  Out: points and tangents by the curve's parameter.  The knots are clamped
and even: 0 k times, 1, 2 and so on, and the last one k times, k being the order; so a curve with as many points as its
order is a Bezier curve.

Source of the equations: L. Piegl, W. Tiller, The NURBS Book, 2nd ed., Springer 1997, chapters 2 and 4 (basis functions,
homogeneous coordinates, derivative of a rational curve).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Nurbs:
    """A curve of control points (n, 3): x, y and weight, of an order from 2 to n.

    Raises
    ------
    ValueError
        For an order that does not fit, or a weight that is not positive.
    """

    points: Array
    order: int
    knots: Array = field(init=False)

    def __post_init__(self) -> None:
        n = len(self.points)
        if not 2 <= self.order <= n:
            raise ValueError(f"{n} control points cannot make a curve of order {self.order}")
        if not (self.points[:, 2] > 0).all():
            raise ValueError("every weight must be positive")
        inner = np.arange(n - self.order + 2, dtype=np.float64)
        edge = self.order - 1
        knots = np.concatenate([np.zeros(edge), inner, np.full(edge, inner[-1])])
        object.__setattr__(self, "knots", knots)

    @property
    def spans(self) -> list[float]:
        """Return the parameters between which the curve is one smooth piece, its ends included."""
        return [float(knot) for knot in np.unique(self.knots)]

    def at(self, u: Sequence[float] | Array) -> tuple[Array, Array]:
        """Return points and derivatives by the parameter (k, 2) each, at parameters (k,)."""
        values = np.asarray(u, dtype=np.float64)
        homogeneous = self.points.copy()
        homogeneous[:, :2] *= self.points[:, 2:]
        basis, slope = self._basis(values, self.order), self._slope(values)
        whole, change = basis @ homogeneous, slope @ homogeneous
        points = whole[:, :2] / whole[:, 2:]
        return points, (change[:, :2] - points * change[:, 2:]) / whole[:, 2:]

    def _basis(self, u: Array, order: int) -> Array:
        """Return the basis functions of an order at parameters (k, number of knots - order), by Cox and de Boor."""
        knots, last = self.knots, self.knots[-1]
        inside = (knots[:-1] <= u[:, None]) & (u[:, None] < knots[1:])
        inside |= (u[:, None] >= last) & (knots[1:] == last) & (knots[:-1] < last)
        basis = inside.astype(np.float64)
        for k in range(2, order + 1):
            left, right = knots[k - 1 : -1] - knots[:-k], knots[k:] - knots[1 : len(knots) - k + 1]
            rise = _ratio(u[:, None] - knots[:-k], left) * basis[:, :-1]
            fall = _ratio(knots[k:] - u[:, None], right) * basis[:, 1:]
            basis = rise + fall
        return basis

    def _slope(self, u: Array) -> Array:
        """Return the derivatives of the basis functions (k, n)."""
        knots, k = self.knots, self.order
        lower = self._basis(u, k - 1)
        left, right = knots[k - 1 : -1] - knots[:-k], knots[k:] - knots[1 : len(knots) - k + 1]
        ones = np.ones((len(u), 1))
        return (k - 1) * (_ratio(ones, left) * lower[:, :-1] - _ratio(ones, right) * lower[:, 1:])


def _ratio(upper: Array, lower: Array) -> Array:
    """Return the quotient, 0 where the divisor is 0, as the basis functions ask."""
    shape = np.broadcast_shapes(upper.shape, lower.shape)
    return np.divide(upper, lower, out=np.zeros(shape), where=np.broadcast_to(lower, shape) != 0.0)
