"""Servo joints as data and as physics: motors, amplifiers, trains, loops, and the crossing to the motor's shaft."""

from trochia.machine.servos.amplifier import DriveTrain, ServoAmplifier
from trochia.machine.servos.loops import (
    LOOPS,
    CascadeLoop,
    NotchData,
    PidLoop,
    PmacLoop,
    ServoLoop,
    ThirtySecondsLoop,
)
from trochia.machine.servos.motors import SERVO_MOTORS, CatalogueDc, CataloguePmsm

__all__ = [
    "LOOPS",
    "SERVO_MOTORS",
    "CascadeLoop",
    "CatalogueDc",
    "CataloguePmsm",
    "DriveTrain",
    "NotchData",
    "PidLoop",
    "PmacLoop",
    "ServoAmplifier",
    "ServoLoop",
    "ThirtySecondsLoop",
]
