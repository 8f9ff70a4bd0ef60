"""A whole machine, as its file describes it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.machine.axes import LETTERS, PathLimits
from trochia.machine.board import BoardLink
from trochia.machine.checks import check
from trochia.machine.codecs import Flag, Quantity, Text
from trochia.machine.compensation import Squareness
from trochia.machine.io import Beam, Spindle
from trochia.machine.panel import Panel
from trochia.machine.probe import Probe
from trochia.machine.schema import Bound, Record, check_bounds, key

if TYPE_CHECKING:
    from trochia.machine.axes import Axis
    from trochia.machine.io import Channel
    from trochia.machine.joints import Joint
    from trochia.machine.kinematics import Kinematics

#: velocity profiles a machine may ask for
PROFILES = ("trapezoid", "s-curve", "torque")
DIALECTS = ("linuxcnc", "grbl", "fanuc", "marlin")  #: those of the G-code reader


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """Axes in the order X Y Z A B C U V W (only those the machine has), joints in kinematic order.

    Attributes
    ----------
    path_tolerance
        Greatest distance between programmed and commanded path where G64 gives no P [mm].
    servo_period
        Period of set-points and recordings [s].
    segment_time
        Least time the drive takes for a segment of the path [s]; shorter ones are slowed; 0 where it takes any.
    tool_change_time
        What a tool change costs [s].
    tools, parameters
        Files that G-code programs find set up, in LinuxCNC's formats; paths are relative to the machine file.
    dialect
        Whose G-code its programs are in, a name of :data:`DIALECTS`.
    allow_user_m_codes
        Whether all of M100 to M199 may be called.
    user_m_codes
        Folder of the programs of M100 to M199, relative to the machine file; None: nothing is run.
    squareness, squareness_error
        Angles between axes that are corrected, and those that the twin's axes have.
    profile
        Velocity profile the machine asks for, a name of :data:`PROFILES`; None leaves it to the planner.

    Raises
    ------
    ConfigError
        At construction, when the parts do not fit together; see :mod:`trochia.machine.checks`.
    """

    name: str = field(metadata=key(Text(), "short name of the machine"))
    description: str = field(default="", metadata=key(Text(), "one line for people"))
    axes: tuple[Axis, ...]
    joints: tuple[Joint, ...]
    kinematics: Kinematics
    path: PathLimits = field(
        default=PathLimits(), metadata=key(Record(PathLimits), "caps on the vector along the path")
    )
    path_tolerance: float = field(
        default=0.01,
        metadata=key(Quantity("length"), "greatest distance to the programmed path without G64 P", Bound.POSITIVE),
    )
    servo_period: float = field(
        default=0.001, metadata=key(Quantity("time"), "period of set-points and recordings", Bound.POSITIVE)
    )
    segment_time: float = field(
        default=0.0,
        metadata=key(Quantity("time"), "least time of a path segment that the drive takes", Bound.NOT_NEGATIVE),
    )
    tool_change_time: float = field(
        default=0.0, metadata=key(Quantity("time"), "what a tool change costs", Bound.NOT_NEGATIVE)
    )
    tools: str | None = field(
        default=None, metadata=key(Text(), "tool table in LinuxCNC's .tbl format, beside the machine file")
    )
    parameters: str | None = field(
        default=None, metadata=key(Text(), "offsets and variables in LinuxCNC's .var format, beside the machine file")
    )
    dialect: str = field(default="linuxcnc", metadata=key(Text(DIALECTS), "whose G-code its programs are in"))
    allow_user_m_codes: bool = field(
        default=False, metadata=key(Flag(), "M100 to M199 of G-code programs are codes of this machine")
    )
    user_m_codes: str | None = field(
        default=None, metadata=key(Text(), "folder of programs M100 to M199 that run calls, beside the machine file")
    )
    profile: str | None = field(
        default=None,
        metadata=key(Text(PROFILES), "velocity profile; without it s-curve where jerk is given, else trapezoid"),
    )
    squareness: Squareness | None = field(
        default=None, metadata=key(Record(Squareness), "angles beyond 90 degrees that are corrected")
    )
    squareness_error: Squareness | None = field(
        default=None, metadata=key(Record(Squareness), "angles beyond 90 degrees that the twin's axes have")
    )
    spindle: Spindle | None = field(default=None, metadata=key(Record(Spindle), "the spindle"))
    beam: Beam | None = field(default=None, metadata=key(Record(Beam), "a laser or the like"))
    probe: Probe | None = field(default=None, metadata=key(Record(Probe), "a touch probe"))
    panel: Panel | None = field(default=None, metadata=key(Record(Panel), "inputs that guard people"))
    board: BoardLink | None = field(default=None, metadata=key(Record(BoardLink), "the board that makes its steps"))
    io: tuple[Channel, ...] = field(default=())

    def __post_init__(self) -> None:
        check_bounds(self)
        check(self)

    @property
    def columns(self) -> tuple[int, ...]:
        """Column of each axis among the nine letters."""
        return tuple(LETTERS.index(axis.name) for axis in self.axes)
