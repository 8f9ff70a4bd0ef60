"""Gains from a bandwidth and a damping, as a commissioning suite asks them, in the form of the joint's own loop.

In: a drive, its model, what is asked.  Out: the data of a PID in physical units, or the I-variables of a motion card.

The plant is taken as one stiff mass, gain / (s (lag s + 1)); its lag is J R / (B R + Kt Kb) under voltage, J / B under
current.  Feed-forward is that of the plant (a card's stands beside the error, so it is divided by the gain), and the
offset of the output takes away what always pushes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.analysis.tuning.rules import bandwidth_and_damping
from trochia.errors import ConfigError
from trochia.machine.servo_plant import Mode
from trochia.machine.servos import PidLoop, PmacLoop
from trochia.servo.axis import Loop
from trochia.servo.forward import feed_forward

if TYPE_CHECKING:
    from trochia.analysis.tuning.models import Gains
    from trochia.machine.servo_plant import ServoPlant
    from trochia.machine.servos.drive import ServoDrive

_BITS = 32768 / 10.0  #: of a card's output, a volt
_LEAST = 1e-9  # of the inertia, friction below which a plant would have no lag


def commissioned(drive: ServoDrive, plant: ServoPlant, *, bandwidth: float, damping: float) -> PidLoop | PmacLoop:
    """Return the loop of a joint.

    Parameters
    ----------
    plant
        Its model: the file's, or what was found.
    bandwidth, damping
        Of the closed loop's poles [Hz], and the damping ratio of two of them.

    Raises
    ------
    ConfigError
        When the plant is quicker than the loop asked for, the amplifier closes the speed, or a gain does not fit.
    """
    if plant.amplifier.mode is Mode.SPEED:
        raise ConfigError("the amplifier closes the speed itself: this rule is for one of torque or voltage",
                          key="amplifier.mode")  # fmt: skip
    asks = feed_forward(plant, Loop(period=drive.period))
    viscous = max(asks.viscous_forward, _LEAST * asks.acceleration_forward)
    gains = bandwidth_and_damping(1.0 / viscous, asks.acceleration_forward / viscous, bandwidth=bandwidth,
                                  damping=damping)  # fmt: skip
    if isinstance(drive.loop, PmacLoop):
        return _card(drive, drive.loop, gains, asks)
    kp, ki, kd = (float(f"{value:.6g}") for value in (gains.kp, gains.ki, gains.kd))
    return PidLoop(kp=kp, ki=ki, kd=kd, velocity_forward=1.0, acceleration_forward=1.0, friction_forward=1.0,
                   period=drive.loop.period)  # fmt: skip


def _card(drive: ServoDrive, old: PmacLoop, gains: Gains, asks: Loop) -> PmacLoop:
    """Return the gains as I-variables; what is not a gain stays as the joint has it."""
    counts, period = drive.plant.counts, drive.period
    assert counts is not None, "a card counts"
    i30 = round(gains.kp / (counts / _BITS) * (1 << 19) / old.i08)
    if i30 < 1:
        raise ConfigError("the gain is less than a card's least", key="bandwidth", hint="Ask for more bandwidth.")
    kp = i30 * old.i08 / (1 << 19) * counts / _BITS  # what it then is
    per = kp * period / 128.0
    return PmacLoop(
        i30=i30, i31=round(gains.kd / (i30 * old.i09 / (1 << 26) * counts / _BITS * period)),
        i33=round(gains.ki / kp * period * (1 << 23)), i32=round((gains.kd + asks.viscous_forward) / per),
        i35=round(asks.acceleration_forward / (per * period)), i34=old.i34, i08=old.i08, i09=old.i09,
        i29=round(asks.bias * _BITS), i63=old.i63, i64=old.i64, i65=old.i65, i67=old.i67, i69=old.i69,
        period=old.period,
    )  # fmt: skip
