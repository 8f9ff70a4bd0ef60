"""What a motor's shaft has to turn."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from trochia.machine.codecs import Quantity
from trochia.machine.schema import Bound, check_bounds, key

CREEP = 0.1  #: speed [rad/s] where regularised dry friction has reached 1/√2 of its value


@dataclass(frozen=True, slots=True, kw_only=True)
class ShaftLoad:
    """A load on the shaft, beside what the motor itself has.

    Attributes
    ----------
    inertia
        Turning with the shaft [kg·m²].
    constant
        Torque against positive rotation, whichever way the shaft turns, as of a weight [N·m].
    friction
        Dry friction, against the motion [N·m].
    viscous
        Torque against the motion for each rad/s [N·m·s/rad].
    """

    inertia: float = field(default=0.0, metadata=key(Quantity("inertia"), "turning with it", Bound.NOT_NEGATIVE))
    constant: float = field(default=0.0, metadata=key(Quantity("torque"), "against positive rotation"))
    friction: float = field(default=0.0, metadata=key(Quantity("torque"), "against the motion", Bound.NOT_NEGATIVE))
    viscous: float = 0.0

    def __post_init__(self) -> None:
        check_bounds(self)


def dry_friction(torque: float, omega: np.ndarray) -> np.ndarray:
    """Return the torque of dry friction against a speed [rad/s]: smooth through zero, over CREEP it is all there.

    A rotor at rest under a torque therefore creeps, at most at CREEP, until the magnetic torque holds it.
    """
    return torque * omega / np.sqrt(omega * omega + CREEP * CREEP)
