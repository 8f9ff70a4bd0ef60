"""The step library: motors under the names users of hobby libraries know, on the twin or on a board.

``Stepper`` ramps (``move_to``, ``run``, ``stop`` …), ``StepperGroup`` arrives together, ``Shield`` is the motor
shield's own way (rpm, counts, excitation).  Pulses go to an output: ``Kept``, ``Calls``, ``TwinOutput``, or anything
with their two methods.  Time is virtual, or paced by the wall clock.
"""

from trochia.stepper.group import StepperGroup
from trochia.stepper.motor import Stepper
from trochia.stepper.outputs import Calls, Kept, StepOutput, TwinOutput
from trochia.stepper.shield import (
    BACKWARD,
    DOUBLE,
    FORWARD,
    INTERLEAVE,
    MICROSTEP,
    SINGLE,
    Shield,
    ShieldMotor,
    Style,
)
from trochia.stepper.shield_twin import Rotor, ShieldTwin
from trochia.stepper.times import PacedTime, Time, VirtualTime

__all__ = [
    "BACKWARD", "DOUBLE", "FORWARD", "INTERLEAVE", "MICROSTEP", "SINGLE", "Calls", "Kept", "PacedTime", "Rotor",
    "Shield", "ShieldMotor", "ShieldTwin", "StepOutput", "Stepper", "StepperGroup", "Style", "Time", "TwinOutput",
    "VirtualTime",
]  # fmt: skip
