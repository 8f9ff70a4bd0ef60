"""What a joint's motor has to move, and the same seen from its shaft.

In: masses and forces in the joint's own travel.  Out: a ShaftLoad, in SI units of the shaft.

A turn of the shaft moves the joint by s, so with r = s/2π [m, or rad over rad]: J = J_shaft + m r², torque = F r/η.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.errors import ConfigError
from trochia.machine.codecs import Number, Quantity
from trochia.machine.motors.shaft import ShaftLoad
from trochia.machine.schema import Bound, check_bounds, key

if TYPE_CHECKING:
    from fractions import Fraction

MM = 1e-3  #: [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLoad:
    """The load of a joint.

    Attributes
    ----------
    mass, friction, force
        [kg], [N], [N]; of a rotary joint [kg·m²], [N·m], [N·m], behind the gear.
    margin
        Part of the motor's torque that planning leaves unused.
    """

    mass: float = field(
        default=0.0, metadata=key(Quantity("mass", motion=True), "moved by the joint; rotary: inertia",
                                  Bound.NOT_NEGATIVE)
    )  # fmt: skip
    inertia: float = field(
        default=0.0, metadata=key(Quantity("inertia"), "on the motor's shaft: screw, pulley, coupling",
                                  Bound.NOT_NEGATIVE)
    )  # fmt: skip
    friction: float = field(
        default=0.0, metadata=key(Quantity("force", motion=True), "against the motion; rotary: torque",
                                  Bound.NOT_NEGATIVE)
    )  # fmt: skip
    force: float = field(
        default=0.0, metadata=key(Quantity("force", motion=True), "against positive motion, as of a weight; rotary: "
                                  "torque")
    )  # fmt: skip
    efficiency: float = field(default=1.0, metadata=key(Number(), "of the transmission", Bound.POSITIVE))
    margin: float = field(
        default=0.3, metadata=key(Number(), "part of the motor's torque that planning leaves unused",
                                  Bound.NOT_NEGATIVE)
    )  # fmt: skip

    def __post_init__(self) -> None:
        check_bounds(self)
        if self.efficiency > 1:
            raise ConfigError(f"must be at most 1, not {self.efficiency:g}", key="efficiency")
        if self.margin >= 1:
            raise ConfigError(f"must be below 1, not {self.margin:g}", key="margin")

    def at_shaft(self, travel_per_turn: Fraction, *, rotary: bool) -> ShaftLoad:
        """Return the load as the motor's shaft has it, for the joint's travel in a turn [mm or degree]."""
        arm = math.radians(float(travel_per_turn)) / math.tau if rotary else float(travel_per_turn) * MM / math.tau
        return ShaftLoad(
            inertia=self.inertia + self.mass * arm * arm / self.efficiency,
            constant=self.force * arm / self.efficiency,
            friction=self.friction * abs(arm) / self.efficiency,
        )
