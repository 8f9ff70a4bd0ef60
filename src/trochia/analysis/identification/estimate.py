"""What an identification finds: numbers, each with its uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray


class Number(NamedTuple):
    """A value and its standard deviation, in ``unit``."""

    value: float
    sigma: float
    unit: str = ""

    def __str__(self) -> str:
        if math.isnan(self.sigma):  # taken as known
            return f"{self.value:.6g} {self.unit}".rstrip()
        digits = 3 if not self.sigma or not math.isfinite(self.sigma) else max(
            1, min(9, 2 + math.floor(math.log10(max(abs(self.value), 1e-300) / self.sigma)))
        )  # fmt: skip
        return f"{self.value:.{digits}g} ± {self.sigma:.2g} {self.unit}".rstrip()


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A model's parameters as they were found.

    Attributes
    ----------
    model
        Name of the model.
    numbers
        Parameters by name.
    rms
        Of what the model leaves over, in the unit of what was measured.
    fit
        1 - variance left over / variance: 1 is perfect.
    samples
        That were used.
    """

    model: str
    numbers: dict[str, Number]
    rms: float
    fit: float
    samples: int

    def __getitem__(self, name: str) -> float:
        """Return a parameter's value."""
        return self.numbers[name].value

    def figures(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        return {
            "model": self.model,
            "parameters": {name: number.value for name, number in self.numbers.items()},
            "uncertainty": {name: None if math.isnan(number.sigma) else number.sigma
                            for name, number in self.numbers.items()},
            "units": {name: number.unit for name, number in self.numbers.items()},
            "rms": self.rms, "fit": self.fit, "samples": self.samples,
        }  # fmt: skip


def least_squares(
    columns: NDArray[np.float64], wanted: NDArray[np.float64], names: Sequence[tuple[str, str]], model: str
) -> Estimate:
    """Return the linear estimate ``columns @ parameters = wanted`` with (name, unit) for each column.

    Uncertainty is that of white noise of the size left over.
    """
    parameters, *_ = np.linalg.lstsq(columns, wanted, rcond=None)
    left = wanted - columns @ parameters
    freedom = max(len(wanted) - len(parameters), 1)
    covariance = np.linalg.pinv(columns.T @ columns) * float(left @ left) / freedom
    return _estimate(model, names, np.stack([parameters, np.sqrt(np.diag(covariance))]), left, wanted)


def fitted(
    model: str,
    function: Callable[..., NDArray[np.float64]],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    *,
    start: Sequence[float],
    names: Sequence[tuple[str, str]],
    bounds: tuple[Sequence[float], Sequence[float]] | None = None,
) -> Estimate:
    """Return the non-linear least-squares fit of ``function(x, *parameters)`` to y, from a start.

    Raises
    ------
    RuntimeError
        When no fit is found.
    """
    from scipy.optimize import curve_fit  # noqa: PLC0415 - scipy is slow to import

    limits = (-np.inf, np.inf) if bounds is None else bounds
    parameters, covariance = curve_fit(function, x, y, p0=list(start), bounds=limits, method="trf")
    left = y - function(x, *parameters)
    return _estimate(model, names, np.stack([parameters, np.sqrt(np.diag(covariance))]), left, y)


def _estimate(
    model: str,
    names: Sequence[tuple[str, str]],
    found: NDArray[Any],
    left: NDArray[np.float64],
    wanted: NDArray[np.float64],
) -> Estimate:
    parameters, sigma = found
    spread = float(np.var(wanted))
    return Estimate(
        model=model,
        numbers={name: Number(float(p), float(s), unit)
                 for (name, unit), p, s in zip(names, parameters, sigma, strict=True)},
        rms=float(np.sqrt(np.mean(left**2))),
        fit=1.0 - float(np.mean(left**2)) / spread if spread else 1.0,
        samples=len(wanted),
    )  # fmt: skip
