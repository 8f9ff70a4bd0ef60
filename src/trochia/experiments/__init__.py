"""Procedures that move a motor: checked before, watched while they run, the motor off at their end whatever happens."""

from trochia.experiments.identify import Identified, identify
from trochia.experiments.perform import perform, powered
from trochia.experiments.protocol import AxisUnderTest, Bounds
from trochia.experiments.twin import TwinAxis

__all__ = ["AxisUnderTest", "Bounds", "Identified", "TwinAxis", "identify", "perform", "powered"]
