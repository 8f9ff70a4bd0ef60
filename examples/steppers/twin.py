"""The motor of the sketches as a twin: its makers' figures, the L293D's drop, a rig that turns no more than itself."""

from __future__ import annotations

from trochia.backends.stepper_twin import StepperTwin
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import ShaftLoad, motor
from trochia.stepper import TwinOutput

SUPPLY = 12.0  # [V]
RIG = ShaftLoad(inertia=1.5e-6, friction=0.005)  # a coupling and a disc; assumed, the source tells nothing of its rig


def rig(mode: str) -> TwinOutput:
    """Return the motor SM-42BYG011-25 on the shield, ``one-phase`` or ``two-phase``."""
    shaft = motor("SM-42BYG011-25").parameters()
    return TwinOutput(StepperTwin(fed(shaft, HBridge(supply=SUPPLY, excitation=mode)), RIG))
