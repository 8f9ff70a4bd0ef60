"""A whole machine, as its file describes it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.machine.axes import Axis, PathLimits
    from trochia.machine.io import Beam, Channel, Spindle
    from trochia.machine.joints import Joint
    from trochia.machine.kinematics import Kinematics


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """Axes in the order X Y Z A B C U V W (only those the machine has), joints in kinematic order.

    Attributes
    ----------
    path_tolerance
        Greatest distance between programmed and commanded path where G64 gives no P [mm].
    servo_period
        Period of set-points and recordings [s].
    tool_change_time
        What a tool change costs [s].
    """

    name: str
    description: str
    axes: tuple[Axis, ...]
    joints: tuple[Joint, ...]
    kinematics: Kinematics
    path: PathLimits
    path_tolerance: float = 0.01
    servo_period: float = 0.001
    tool_change_time: float = 0.0
    spindle: Spindle | None = None
    beam: Beam | None = None
    io: tuple[Channel, ...] = field(default=())

    @property
    def columns(self) -> tuple[int, ...]:
        """Column of each axis among the nine letters."""
        return tuple("XYZABCUVW".index(axis.name) for axis in self.axes)
