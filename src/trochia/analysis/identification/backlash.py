"""The gap in a drive train, and how dry friction divides between motor and load, from slow reversals.

In: what an axis did with an encoder on the motor only, its loop, and its two masses.  Out: gap, Coulomb friction of
either side.  Behind a reversal the train unwinds, the motor crosses the gap alone, and takes the load along again: the
loop's error tells how long each took.  The model runs the same set-points under the same loop; gap and friction are
those with which it does what was measured.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.identification.estimate import Estimate, Number
from trochia.errors import LimitError, RecordingError
from trochia.machine.friction import Friction
from trochia.servo.axis import ServoAxis

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop

    Array = NDArray[np.float64]

_STEP = 2e-5  # of the model [s]
_GAPS = 14  # first guesses, from half a count on
_SHARES = (0.3, 0.4, 0.5, 0.6, 0.7)
_TRIED = 3  # best guesses from which a fit starts


def with_gap(plant: ServoPlant, gap: float, coulomb: float, share: float, smooth: float) -> ServoPlant:
    """Return the plant with a gap and dry friction of which the load has a share."""
    one, two = plant.motor_friction, plant.load_friction
    return replace(
        plant, gap=gap,
        motor_friction=Friction(coulomb=coulomb * (1.0 - share), viscous=one.viscous, offset=one.offset, smooth=smooth),
        load_friction=Friction(coulomb=coulomb * share, viscous=two.viscous, smooth=smooth),
    )  # fmt: skip


def gap_by_reversal(
    plant: ServoPlant, loop: Loop, wanted: Array, measured: Array, *, coulomb: float, greatest: float,
    first: int = 0, smooth: float = 1e-3,
) -> Estimate:  # fmt: skip
    """Return gap, Coulomb friction of both, and the load's share of it.

    Parameters
    ----------
    plant
        The two masses as they were found; its gap and dry friction are not looked at.
    wanted, measured
        Set-points (ticks, 3) and the motor's position (ticks,), from rest.
    coulomb
        Friction of both together, at steady speeds.
    greatest
        Gap that may be.
    first
        Tick of the first turn: where things lay before is not known, so nothing before it counts.
    smooth
        Speed over which friction turns its sign.

    Raises
    ------
    RecordingError
        When no gap explains what was measured.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 - scipy is slow to import

    half = 0.5 / plant.counts if plant.counts else 0.0  # an encoder tells the count below
    exact = replace(plant, counts=None)
    scale = 1.0 / plant.counts if plant.counts else float(np.ptp(measured)) * 1e-4

    def left(parameters: Array) -> Array:
        size, level, share = parameters
        model = with_gap(exact, size * scale, level * coulomb, share, smooth)
        try:
            samples = ServoAxis(model, loop, position=float(measured[0]), step=_STEP).run(wanted)
        except LimitError:
            return np.full(len(measured) - first, 1e6)
        return (samples.measured - measured - half)[first:] / scale

    sizes = np.geomspace(0.5, max(greatest / scale, 1.0), _GAPS)
    guesses = [np.array([size, 1.0, share]) for size in sizes for share in _SHARES]
    guesses.sort(key=lambda guess: float(np.sum(left(guess) ** 2)))
    fits = [_refined(least_squares, left, guess, greatest / scale) for guess in guesses[:_TRIED]]
    best = min(fits, key=lambda fit: fit.cost)
    rest = left(best.x)
    spread = float(np.var((measured - wanted[:, 0])[first:])) / scale**2
    fit = 1.0 - float(np.mean(rest**2)) / spread
    if fit < 0.5:
        raise RecordingError(f"no gap explains these reversals (fit {fit:.2f})",
                             hint="Was the axis at rest at the start, and the loop the one that ran?")  # fmt: skip
    return _estimate(best, rest, {"gap": scale, "coulomb": coulomb, "coulomb_share": 1.0}, fit)


def _estimate(best: Any, rest: Array, unit: dict[str, float], fit: float) -> Estimate:  # noqa: ANN401 - scipy's
    """Return the estimate of a fit whose parameters are in these units."""
    variance = float(rest @ rest) / max(len(rest) - 3, 1)
    sigma = np.sqrt(np.diag(np.linalg.pinv(best.jac.T @ best.jac)) * variance)
    names = {"gap": "rad", "coulomb": "N·m", "coulomb_share": ""}
    return Estimate(
        model="backlash",
        numbers={
            name: Number(float(x) * unit[name], float(s) * unit[name], names[name])
            for name, x, s in zip(unit, best.x, sigma, strict=True)
        },
        rms=float(np.sqrt(np.mean(rest**2))) * unit["gap"],
        fit=fit,
        samples=len(rest),
    )


def _refined(solver: Callable[..., Any], left: Callable[[Array], Array], guess: Array, most: float) -> Any:  # noqa: ANN401 - scipy's
    """Return the fit from a guess; a second one from where the first ended frees it from a step too coarse."""
    bounds = ([0.0, 0.5, 0.0], [1.5 * most + 1.0, 1.5, 1.0])
    fit: Any = None
    for size in (3e-2, 5e-3):
        steps = np.array([size * max(1.0, 1.0 / max(guess[0], 1e-2)), size, size])
        fit = solver(left, guess, diff_step=steps, x_scale=[max(guess[0], 1.0), 0.1, 0.1], bounds=bounds)
        guess = np.clip(fit.x, [1e-2, 0.5, 1e-3], [1.5 * most, 1.5, 1.0 - 1e-3])
    return fit


def gap_by_switch(back_length: float, slip: float, *, wind_up: float = 0.0) -> float:
    """Return the gap from a limit switch (the electronic leadscrew's procedure).

    Parameters
    ----------
    back_length
        Way of the motor from standstill until the switch opened again.
    slip
        Its way from where the switch closed to standstill.
    wind_up
        By how much friction twists the train, both ways together: 2 x friction of the load / stiffness.
    """
    return back_length - slip - wind_up
