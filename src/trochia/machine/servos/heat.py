"""Heat of linear regulators and bridges, and the heatsink that takes it away.

In: voltages dropped, currents, thermal resistances.  Out: watts and kelvins, by

    P = V I          T_junction - T_ambient = P (R_jc + R_ch + R_ha)          R = x / (k A) through a plate

so a heatsink may have at most R_ha = dT / P - (R_jc + R_ch).  (The electronic leadscrew's own account has the inner
sign the other way, dT / P - (R_jc - R_ch).)
"""

from __future__ import annotations

from dataclasses import dataclass

from trochia.errors import ConfigError


def loss(drop: float, current: float, *, duty: float = 1.0) -> float:
    """Return the heat of a drop [V] under a current [A] for a part of the time [W]."""
    return drop * current * duty


@dataclass(frozen=True, slots=True, kw_only=True)
class Device:
    """One device on a heatsink.

    Attributes
    ----------
    power
        Its heat [W].
    junction_case, case_sink
        Thermal resistances [K/W].
    """

    power: float
    junction_case: float
    case_sink: float

    def __post_init__(self) -> None:
        for name in ("power", "junction_case"):
            if not getattr(self, name) > 0:
                raise ConfigError(f"must be above zero, not {getattr(self, name)!r}", key=name)
        if self.case_sink < 0:
            raise ConfigError(f"must not be below zero, not {self.case_sink!r}", key="case_sink")

    def rise(self, sink_ambient: float, *, others: float = 0.0) -> float:
        """Return how much its junction is above ambient [K], with the heat of others on the same sink [W]."""
        inner = self.power * (self.junction_case + self.case_sink)
        return inner + (self.power + others) * sink_ambient


def heatsink(rise: float, *devices: Device) -> float:
    """Return the greatest thermal resistance of a heatsink that devices share [K/W], for a junction's rise [K].

    Raises
    ------
    ConfigError
        When some junction would be hotter on any heatsink.
    """
    whole = sum(device.power for device in devices)
    spare = min(rise - device.power * (device.junction_case + device.case_sink) for device in devices)
    if not spare > 0:
        raise ConfigError(
            f"no heatsink keeps the rise within {rise:g} K: junction to sink alone takes more", key="rise"
        )
    return spare / whole


def heatsink_as_printed(rise: float, device: Device) -> float:
    """Return the same of one device with the inner sign wrong, as it was printed [K/W]: it promises too much."""
    return rise / device.power - (device.junction_case - device.case_sink)


def conduction(thickness: float, conductivity: float, area: float) -> float:
    """Return the thermal resistance of a plate [K/W] of a thickness [m], conductivity [W/(m·K)] and area [m²]."""
    return thickness / (conductivity * area)
