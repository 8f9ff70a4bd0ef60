"""Drivers as physics: what stands between step pulses, a supply and a stepper's phases."""

from trochia.machine.drivers.bridge import L293D_DROPS, Bridge, Output, bridge_voltage, half_bridge, shoot_through
from trochia.machine.drivers.chip import Chip
from trochia.machine.drivers.chips import CHIPS
from trochia.machine.drivers.chopper import Chopper
from trochia.machine.drivers.fed import Driver, Fed, fed
from trochia.machine.drivers.thermal import Heat, heat
from trochia.machine.drivers.voltage import HBridge, SeriesResistor

LAWS: dict[str, type[HBridge | SeriesResistor | Chopper]] = {
    cls.kind: cls for cls in (HBridge, SeriesResistor, Chopper)
}  #: how a phase can be fed
DRIVERS = LAWS | CHIPS  #: kinds of a machine file

__all__ = [
    "CHIPS",
    "DRIVERS",
    "L293D_DROPS",
    "LAWS",
    "Bridge",
    "Chip",
    "Chopper",
    "Driver",
    "Fed",
    "HBridge",
    "Heat",
    "Output",
    "SeriesResistor",
    "bridge_voltage",
    "fed",
    "half_bridge",
    "heat",
    "shoot_through",
]
