"""Tuning rules with a formula: Ziegler and Nichols, SIMC, Tyreus and Luyben.

In: a model.  Out: gains.  Symbols: K gain, T lag, L dead time of the plant; Ku, Tu ultimate gain and period.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from trochia.analysis.tuning.models import Fopdt, Gains, Integrating, Ultimate
from trochia.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Callable


def ziegler_nichols_open(model: Fopdt) -> Gains:
    """Return PID gains from the reaction curve: a = K L / T, Kp = 1.2 / a, Ti = 2 L, Td = L / 2 (1942)."""
    a, dead = model.gain * model.dead / model.lag, model.dead
    return Gains(kp=1.2 / a, ki=0.6 / (a * dead), kd=0.6 * dead / a)


def ziegler_nichols_closed(model: Ultimate) -> Gains:
    """Return PID gains from the ultimate gain: Kp = 0.6 Ku, Ti = Tu / 2, Td = Tu / 8 (1942).

    Raises
    ------
    ConfigError
        When the plant's gain is known and 2 < K Ku < 20 does not hold, outside of which the rule is no good.
    """
    if model.plant_gain is not None and not 2.0 < abs(model.plant_gain) * model.gain < 20.0:
        raise ConfigError(f"K Ku is {abs(model.plant_gain) * model.gain:.3g}; this rule is for 2 to 20", key="ultimate",
                          hint="Take SIMC, or pole placement.")  # fmt: skip
    kp = 0.6 * model.gain
    return Gains(kp=kp, ki=2.0 * kp / model.time, kd=kp * model.time / 8.0)


def ziegler_nichols_pi(model: Ultimate) -> Gains:
    """Return PI gains from the ultimate gain: Kp = 0.45 Ku, Ti = Tu / 1.2 (1942)."""
    kp = 0.45 * model.gain
    return Gains(kp=kp, ki=1.2 * kp / model.time)


def tyreus_luyben(model: Ultimate) -> Gains:
    """Return the gentler PI gains for integrating plants: Kp = Ku / 3.2, Ti = 2.2 Tu (1992)."""
    kp = model.gain / 3.2
    return Gains(kp=kp, ki=kp / (2.2 * model.time))


def simc(model: Fopdt | Integrating, *, closed: float | None = None) -> Gains:
    """Return PI gains by Skogestad's rule (2003): Kp = T / (K (tc + L)), Ti = min(T, 4 (tc + L)).

    An integrating plant has T and K grow together, so Kp = 1 / (K' (tc + L)), Ti = 4 (tc + L).

    Parameters
    ----------
    closed
        Time constant tc of the closed loop [s]; None: the dead time, which is fast and still robust.
    """
    tc = model.dead if closed is None else closed
    if not tc > -model.dead or (closed is not None and closed <= 0.0):
        raise ConfigError(f"must be above zero, not {tc!r} s", key="closed")
    if isinstance(model, Integrating):
        kp, ti = 1.0 / (model.gain * (tc + model.dead)), 4.0 * (tc + model.dead)
    else:
        kp, ti = model.lag / (model.gain * (tc + model.dead)), min(model.lag, 4.0 * (tc + model.dead))
    return Gains(kp=kp, ki=kp / ti)


def bandwidth_and_damping(gain: float, lag: float, *, bandwidth: float, damping: float) -> Gains:
    """Return PID gains that place the poles of position control of gain / (s (lag s + 1)).

    Two at the bandwidth [Hz] and damping asked for, the third at the same distance, real: what a commissioning suite
    asks (bandwidth and damping ratio) and the classic pole placement give.  lag s³ + (1 + K Kd) s² + K Kp s + K Ki is
    matched to lag (s + w)(s² + 2 z w s + w²).

    Raises
    ------
    ConfigError
        When the bandwidth is below what the plant does by itself, so that a gain would be negative.
    """
    if not (bandwidth > 0.0 and damping > 0.0 and lag > 0.0 and gain != 0.0):
        raise ConfigError("bandwidth, damping, lag and gain must be above zero", key="bandwidth")
    w = 2.0 * math.pi * bandwidth
    kd = (lag * w * (1.0 + 2.0 * damping) - 1.0) / gain
    if kd * gain < 0.0:
        least = 1.0 / (lag * (1.0 + 2.0 * damping)) / (2.0 * math.pi)
        raise ConfigError(f"at {bandwidth:g} Hz the plant is quicker than the loop: a gain would be negative",
                          key="bandwidth", hint=f"Ask for at least {least:.3g} Hz.")  # fmt: skip
    return Gains(kp=lag * w * w * (1.0 + 2.0 * damping) / gain, ki=lag * w**3 / gain, kd=kd)


#: name -> rule on a model with dead time, or on an ultimate gain
FOPDT_RULES: dict[str, Callable[[Fopdt], Gains]] = {"ziegler-nichols": ziegler_nichols_open, "simc": simc}
ULTIMATE_RULES: dict[str, Callable[[Ultimate], Gains]] = {
    "ziegler-nichols-closed": ziegler_nichols_closed,
    "ziegler-nichols-pi": ziegler_nichols_pi,
    "tyreus-luyben": tyreus_luyben,
}
