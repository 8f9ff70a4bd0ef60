"""A brushed motor behind an H bridge: what its inputs do, and how far it runs on.

In: levels of the bridge's inputs; a plant and a speed.  Out: what becomes of the winding; closed forms of the way.

    enable  inputs    winding                          enable  inputs   winding
    0       any       open: the motor runs free        1       unlike   driven one way or the other
    1       alike     shorted: the motor is braked by its own voltage

From speed w0 to w1 under J dw/dt = -(B w + C), with B w + C above zero,

    way = J/B (w0 - w1 - C/B ln((B w0 + C) / (B w1 + C)))        time = J/B ln((B w0 + C) / (B w1 + C))

B and C are viscous and dry friction; braked, Kt Kb / R adds to B, and a bridge's drop takes Kt drop / R from C as long
as the motor's voltage is above it.  The winding's inductance is left out: it is gone within its L/R.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from trochia.errors import LimitError
from trochia.machine.drivers.bridge import Output, half_bridge
from trochia.machine.servo_plant import Power

if TYPE_CHECKING:
    from trochia.machine.servo_plant import ServoPlant

_TINY = 1e-12  # of friction, below which there is none


class Driven(NamedTuple):
    """What a bridge does with a winding; ``way`` 1 or -1 where it drives it, else 0."""

    power: Power
    way: int


def driven(*, enable: bool, a: bool, b: bool) -> Driven:
    """Return what the levels of a bridge's enable and two inputs do."""
    one, two = half_bridge(a, enable), half_bridge(b, enable)
    if one is Output.OPEN:
        return Driven(Power.FREE, 0)
    if one is two:
        return Driven(Power.BRAKED, 0)
    return Driven(Power.DRIVEN, 1 if one is Output.HIGH else -1)


class OverRun(NamedTuple):
    """Way [rad] and time [s] to standstill."""

    way: float
    time: float


def over_run(plant: ServoPlant, speed: float, power: Power) -> OverRun:
    """Return how far a motor runs on from a speed [rad/s], free or braked.

    Raises
    ------
    LimitError
        When nothing stops it.
    """
    viscous = plant.motor_friction.viscous + plant.load_friction.viscous
    dry = plant.motor_friction.coulomb + plant.load_friction.coulomb
    inertia, there = plant.motor_inertia + plant.load_inertia, abs(speed)
    way = time = 0.0
    if power is Power.BRAKED and plant.emf_constant > 0.0:
        least = min(plant.amplifier.drop / plant.emf_constant, there)  # below it the bridge lets no current pass
        more = plant.torque_constant / plant.resistance
        braked = _between(inertia, viscous + more * plant.emf_constant, dry - more * plant.amplifier.drop, there, least)
        way, time, there = braked.way, braked.time, least
    if there > 0.0:
        rest = _between(inertia, viscous, dry, there, 0.0)
        way, time = way + rest.way, time + rest.time
    return OverRun(way, time)


def _between(inertia: float, viscous: float, dry: float, fast: float, slow: float) -> OverRun:
    if fast <= slow:
        return OverRun(0.0, 0.0)
    if viscous <= _TINY * inertia:
        if dry <= 0.0:
            raise LimitError("nothing stops this motor: it has neither friction nor a brake",
                             hint="Give the friction of motor or load.")  # fmt: skip
        return OverRun(inertia * (fast * fast - slow * slow) / (2.0 * dry), inertia * (fast - slow) / dry)
    lag, level = inertia / viscous, dry / viscous
    end = slow + level
    if end <= 0.0:  # viscous friction alone never ends; the way does
        return OverRun(lag * (fast - slow), math.inf)
    turns = math.log((fast + level) / end)
    return OverRun(lag * (fast - slow - level * turns), lag * turns)
