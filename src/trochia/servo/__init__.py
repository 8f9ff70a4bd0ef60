"""How a loop is closed: PID forms, filters, feed-forward, cascades, and the integer laws of real controllers."""

from trochia.servo.axis import Loop, ServoAxis
from trochia.servo.filters import Biquad, first_order, low_pass, notch
from trochia.servo.pid import Pid, PidController, Sampling, Windup

__all__ = [
    "Biquad",
    "Loop",
    "Pid",
    "PidController",
    "Sampling",
    "ServoAxis",
    "Windup",
    "first_order",
    "low_pass",
    "notch",
]
