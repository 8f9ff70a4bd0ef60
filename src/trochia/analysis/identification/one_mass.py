"""One mass and the lag of what drives it, from a frequency response.

    y / u = 1 / ((J s² + b s) (lag s + 1))

as it is seen by a sampled loop.  Without the lag the fit would take its phase for mechanics: 0.3 ms at 100 Hz are 11
degrees.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.identification.estimate import Estimate, Number
from trochia.analysis.identification.two_mass import FEWEST, FLOOR, MOST_LAG, TRUSTED, distance
from trochia.errors import RecordingError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant
from trochia.servo.sampled import plant_response

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.analysis.identification.response import FrequencyResponse

    Array = NDArray[np.float64]


def one_mass(measured: FrequencyResponse, *, inertia: float, viscous: float) -> Estimate:
    """Return the inertia, and the lag of the torque behind the command.

    Parameters
    ----------
    measured
        Position by torque.
    inertia
        To start from [kg·m²].
    viscous
        Friction, as steady speeds tell it [N·m·s/rad].

    Raises
    ------
    RecordingError
        When there are too few lines.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 - scipy is slow to import

    used = measured.trusted(TRUSTED)
    if len(used.frequency) < FEWEST:
        raise RecordingError(f"only {len(used.frequency)} lines are coherent; at least {FEWEST} are needed",
                             hint="Excite more strongly, or measure more periods.")  # fmt: skip
    weight = 1.0 / np.maximum(used.relative_sigma, FLOOR)

    def model(parameters: Array) -> NDArray[np.complex128]:
        logarithm, ticks = parameters
        plant = ServoPlant(amplifier=Amplifier(lag=float(ticks) * used.period), motor_inertia=math.exp(logarithm),
                           motor_friction=Friction(viscous=viscous))  # fmt: skip
        return plant_response(plant, used.frequency, used.period)

    def off(parameters: Array) -> Array:
        return distance(model(parameters), used.value, weight)

    start = math.log(inertia)
    fit: Any = least_squares(
        off, [start, 0.1], x_scale=[0.1, 0.1], loss="soft_l1",
        bounds=([start - 3.0, 0.0], [start + 3.0, MOST_LAG]),
    )  # fmt: skip
    left = off(fit.x)
    sigma = np.sqrt(np.diag(np.linalg.pinv(fit.jac.T @ fit.jac)) * float(left @ left) / max(len(left) - 2, 1))
    found = math.exp(fit.x[0])
    missed = np.abs(model(fit.x) / used.value - 1.0)
    return Estimate(
        model="one-mass",
        numbers={"motor_inertia": Number(found, found * float(sigma[0]), "kg·m²"),
                 "lag": Number(float(fit.x[1]) * used.period, float(sigma[1]) * used.period, "s")},
        rms=float(np.sqrt(np.mean(missed**2))), fit=float(1.0 - np.mean(missed**2)), samples=len(used.frequency),
    )  # fmt: skip
