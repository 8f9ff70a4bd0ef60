"""Motors as physics: parameters, equations, and a library of real ones.  Everything is in SI units of the shaft."""

from trochia.machine.motors.catalogue import CatalogueStepper
from trochia.machine.motors.hybrid import HybridStepper
from trochia.machine.motors.library import library, motor, rows_of
from trochia.machine.motors.reluctance import ReluctanceStepper
from trochia.machine.motors.shaft import ShaftLoad

__all__ = ["CatalogueStepper", "HybridStepper", "ReluctanceStepper", "ShaftLoad", "library", "motor", "rows_of"]
