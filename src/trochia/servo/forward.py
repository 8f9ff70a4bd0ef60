"""Feed-forward by inverse dynamics: the command that the nominal plant needs to do what is wanted, before any error.

In: a plant and a loop.  Out: the loop with its feed-forward set, so that on the nominal plant following error vanishes
(but for sampling, quantisation and what a train's spring gives way).

    torque  = J a + B v + Fc sign v + load
    command = torque / (Kt gain)                     of an amplifier that sets the current
            = (R torque / Kt + Kb v + drop) / gain   of one that sets the voltage
            = v / gain                               of one that sets the speed: its own loop finds the torque

What a controller does with the speed *measured* it would do against the motion; that is given to it on top.  A speed
from the last n periods is n T/2 late: under acceleration it falls short by a n T/2, which a controller takes for an
error of speed and pushes for.  What that push comes to is taken off: Kp a n T/2, and of the integral Ki v n T/2.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from trochia.machine.servo_plant import Mode

if TYPE_CHECKING:
    from trochia.machine.servo_plant import ServoPlant
    from trochia.servo.axis import Loop


def feed_forward(
    plant: ServoPlant, loop: Loop, *, velocity: float = 1.0, acceleration: float = 1.0, friction: float = 1.0
) -> Loop:
    """Return the loop with the feed-forward of its nominal plant.

    Parameters
    ----------
    velocity, acceleration, friction
        Parts of what velocity, acceleration and dry friction ask that are fed forward; ``velocity`` is also the part
        of the speed wanted that a speed controller is told.
    """
    amplifier, motor, load = plant.amplifier, plant.motor_friction, plant.load_friction
    if amplifier.mode is Mode.SPEED:
        damping = 0.0 if loop.position is None else loop.position.kd * (1.0 - loop.position.c)
        return replace(loop, viscous_forward=velocity * (1.0 / amplifier.gain + damping),
                       acceleration_forward=-acceleration * damping * 0.5 * loop.period)  # fmt: skip
    late = 0.5 * loop.period * loop.averaged
    volts = amplifier.mode is Mode.VOLTAGE
    a_newton = (plant.resistance if volts else 1.0) / (plant.torque_constant * amplifier.gain)
    viscous = (motor.viscous + load.viscous) * a_newton + (plant.emf_constant / amplifier.gain if volts else 0.0)
    inertia = (plant.motor_inertia + plant.load_inertia) * a_newton
    if volts:
        inertia += plant.inductance / plant.resistance * viscous  # L di/dt of the current that speed asks for
    dry = (motor.coulomb + load.coulomb) * a_newton + (amplifier.drop / amplifier.gain if volts else 0.0)
    if loop.speed is not None:
        inertia, viscous = inertia - loop.speed.kp * late, viscous - loop.speed.ki * late
    elif loop.position is not None:
        damping = loop.position.kd * (1.0 - loop.position.c)
        viscous, inertia = viscous + damping, inertia - damping * 0.5 * loop.period
    return replace(
        loop,
        speed_forward=velocity if loop.speed is not None else 0.0,
        viscous_forward=velocity * viscous,
        acceleration_forward=acceleration * inertia,
        friction_forward=friction * dry,
        friction_smooth=motor.smooth if dry else loop.friction_smooth,
        bias=loop.bias + (plant.load + motor.offset + load.offset) * a_newton * friction,
    )
