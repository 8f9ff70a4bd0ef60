"""How steps are made: exact step timing, what a driver asks of it, and the classic interpolators."""

from trochia.pulses.interpolators import INTERPOLATORS
from trochia.pulses.steps import CLOCK, StepBlock, step_blocks
from trochia.pulses.timing import PulseCheck, Violation

__all__ = ["CLOCK", "INTERPOLATORS", "PulseCheck", "StepBlock", "Violation", "step_blocks"]
