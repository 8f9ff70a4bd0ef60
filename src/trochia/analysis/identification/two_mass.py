"""Two masses and what joins them, from a frequency response.

    y / u = (Jl s² + (d + b2) s + k) / ((Jm s² + (d + b1) s + k)(Jl s² + (d + b2) s + k) - (d s + k)²)

as it is seen by a sampled loop (the torque held over each tick), behind the lag of the current loop, 1 / (lag s + 1).
Symbols: Jm, Jl inertias of motor and load, k stiffness, d damping, b1, b2 viscous friction of motor and load.  The
notch of y / u is at sqrt(k / Jl), its peak at sqrt(k (1/Jm + 1/Jl)); both start the fit.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.analysis.identification.estimate import Estimate, Number
from trochia.errors import RecordingError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant
from trochia.servo.sampled import plant_response

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.analysis.identification.response import FrequencyResponse

    Array = NDArray[np.float64]

FEWEST = 12  #: lines for a fit
MOST_LAG = 20.0  #: of the torque behind its command [ticks]
TRUSTED = 0.8  #: coherence from which on a line is used
FLOOR = 2e-3  #: relative error below which no line is trusted
NAMES = (("motor_inertia", "kg·m²"), ("load_inertia", "kg·m²"), ("stiffness", "N·m/rad"), ("damping", "N·m·s/rad"))


def plant_of(parameters: Sequence[float], viscous: float, lag: float = 0.0) -> ServoPlant:
    """Return the plant of (Jm, Jl, k, d, the load's share of the viscous friction), its command a torque."""
    jm, jl, k, d, share = parameters
    return ServoPlant(
        amplifier=Amplifier(lag=lag), motor_inertia=jm, load_inertia=jl, stiffness=k, damping=d,
        motor_friction=Friction(viscous=viscous * (1.0 - share)), load_friction=Friction(viscous=viscous * share),
    )  # fmt: skip


def distance(model: NDArray[np.complex128], measured: NDArray[np.complex128], weight: Array) -> Array:
    """Return what a fit makes small (2 lines,): logarithm of size, and phase, of model over measured.

    In logarithms a ratio of 2 and of 1/2 count alike, and notches are not drowned by peaks.
    """
    off = model / measured
    return np.concatenate([np.log(np.abs(off)) * weight, np.angle(off) * weight])


def peaks(measured: FrequencyResponse) -> tuple[float, float]:
    """Return the frequencies of notch and peak [Hz] of position by torque, its 1/f² taken off.

    Raises
    ------
    RecordingError
        When there is no notch below a peak.
    """
    f = measured.frequency
    flat = np.log(np.abs(measured.value) * f * f)
    smooth = np.convolve(np.pad(flat, 1, mode="edge"), [0.25, 0.5, 0.25], mode="valid")
    # the pair with the greatest rise between them
    lowest = np.minimum.accumulate(smooth)
    top = int(np.argmax(smooth - lowest))
    bottom = int(np.argmin(smooth[: top + 1]))
    if smooth[top] - smooth[bottom] < 0.7 or bottom in {0, top}:
        raise RecordingError("there is no notch with a peak above it: this looks like one mass, not two",
                             hint="Excite a wider band, or take the model of one mass.")  # fmt: skip
    return float(f[bottom]), float(f[top])


def coupling_response(found: Estimate, frequency: Array) -> NDArray[np.complex128]:
    """Return the torque through the drive train by the motor's (lines,): what opens a gap."""
    s = 2j * np.pi * frequency
    jm, jl, k, d = (found[name] for name, _ in NAMES)
    train = d * s + k
    return np.asarray(train * jl * s * s / ((jm * s * s + train) * (jl * s * s + train) - train * train), np.complex128)


def two_mass(measured: FrequencyResponse, *, viscous: float) -> Estimate:
    """Return inertias, stiffness, damping, the lag of the torque behind the command, and the notch and peak they give.

    Parameters
    ----------
    measured
        Position of the motor by its torque.
    viscous
        Friction of both together, as steady speeds tell it [N·m·s/rad]; the response fits its share of each.

    Raises
    ------
    RecordingError
        When there are too few lines, or no resonance.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 - scipy is slow to import

    used = measured.trusted(TRUSTED)
    if len(used.frequency) < FEWEST:
        raise RecordingError(f"only {len(used.frequency)} lines are coherent; at least {FEWEST} are needed",
                             hint="Excite more strongly, or measure more periods.")  # fmt: skip
    notch, peak = peaks(used)
    weight = 1.0 / np.maximum(used.relative_sigma, FLOOR)

    def left(logarithms: Array) -> Array:
        *logs, share, ticks = logarithms
        plant = plant_of([*np.exp(logs), share], viscous, ticks * used.period)
        return distance(plant_response(plant, used.frequency, used.period), used.value, weight)

    starts = _start(used, notch, peak)
    fits: list[Any] = [
        least_squares(
            left,
            [*start, 0.5, 0.1],
            x_scale=[0.1, 0.1, 0.1, 0.5, 0.3, 0.1],
            loss="soft_l1",
            bounds=([v - 3.0 for v in start] + [0.0, 0.0], [v + 3.0 for v in start] + [1.0, MOST_LAG]),
        )
        for start in starts
    ]
    found = fits[int(np.argmin([fit.cost for fit in fits]))]
    return _estimate(found.x, found.jac, left(found.x), used, viscous)


def _start(used: FrequencyResponse, notch: float, peak: float) -> list[list[float]]:
    """Return logarithms of Jm, Jl, k, d to start from, for a weak and a strong damping."""
    w = 2.0 * math.pi * used.frequency
    low = used.frequency <= max(0.5 * notch, used.frequency[2])
    total = float(np.median(1.0 / (np.abs(used.value[low]) * w[low] ** 2)))
    ratio = max((peak / notch) ** 2 - 1.0, 1e-3)
    jm, jl = total / (1.0 + ratio), total * ratio / (1.0 + ratio)
    k = jl * (2.0 * math.pi * notch) ** 2
    critical = 2.0 * math.sqrt(k * jm * jl / (jm + jl))
    return [[math.log(v) for v in (jm, jl, k, zeta * critical)] for zeta in (0.01, 0.05)]


def _estimate(x: Array, jacobian: Array, left: Array, used: FrequencyResponse, viscous: float) -> Estimate:
    """Return the estimate; uncertainty is that of what the model leaves over."""
    *logs, share, ticks = x
    variance = max(float(left @ left) / max(len(left) - len(x), 1), 0.0)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * variance
    sigma = np.sqrt(np.diag(covariance))
    values = np.exp(logs)
    numbers = {name: Number(float(v), float(v * s), unit)
               for (name, unit), v, s in zip(NAMES, values, sigma[:4], strict=True)}  # fmt: skip
    jm, jl, k, _ = values
    numbers["load_share"] = Number(float(share), float(sigma[4]))
    numbers["lag"] = Number(float(ticks) * used.period, float(sigma[5]) * used.period, "s")
    for name, w in (("notch", math.sqrt(k / jl)), ("peak", math.sqrt(k / jl + k / jm))):
        numbers[name] = Number(w / (2 * math.pi), w / (4 * math.pi) * float(np.hypot(sigma[2], sigma[1])), "Hz")
    numbers["viscous"] = Number(viscous, math.nan, "N·m·s/rad")
    model = plant_response(
        plant_of([*values, float(share)], viscous, numbers["lag"].value), used.frequency, used.period
    )
    off = np.abs(model / used.value - 1.0)
    return Estimate(model="two-mass", numbers=numbers, rms=float(np.sqrt(np.mean(off**2))),
                    fit=float(1.0 - np.mean(off**2)), samples=len(used.frequency))  # fmt: skip
