"""What a program finds set up on the machine: offsets, tools, variables, and the points it can return to."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from trochia.program.modes import AXES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from trochia.program.tools import Offsets, Tool

SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")  #: coordinate systems 1 to 9
_NONE: Offsets = (0.0,) * 9


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkState:
    """Offsets and stored points, all in machine coordinates [mm, degree].

    Attributes
    ----------
    systems
        Origins of G54 to G59.3 (9, 9).
    rotations
        Turn of each about Z (9) [degree].
    active
        The system in force, 1 for G54.
    g92, g92_on
        The G92 offset, and whether it applies.
    g28, g30
        Where G28 and G30 go (9).
    tools
        The tool table, in its order; None: no table, and every tool may be called, without length or diameter.
    tool
        Number of the tool in the spindle; 0: none.
    tool_offset
        Tool offset in force (9).
    variables
        Numbered variables that outlast a program, {number: value}; offsets and points are not among them.
    unit
        Length in which variables tell points and offsets: that of the machine [mm].
    user_codes
        Whether M100 to M199 may be called, or which of them.
    """

    systems: tuple[Offsets, ...] = (_NONE,) * 9
    rotations: Offsets = _NONE
    active: int = 1
    g92: Offsets = _NONE
    g92_on: bool = False
    g28: Offsets = _NONE
    g30: Offsets = _NONE
    tools: tuple[Tool, ...] | None = None
    tool: int = 0
    tool_offset: Offsets = _NONE
    variables: Mapping[int, float] = field(default_factory=dict[int, float])
    unit: float = 1.0
    user_codes: bool | frozenset[int] = False

    def __post_init__(self) -> None:
        if not 1 <= self.active <= len(SYSTEMS):
            raise ValueError(f"active is a coordinate system from 1 to {len(SYSTEMS)}, not {self.active}")
        if len(self.systems) != len(SYSTEMS) or len(self.rotations) != len(SYSTEMS):
            raise ValueError(f"systems and rotations have {len(SYSTEMS)} entries each")
        for name, offsets in (*zip(SYSTEMS, self.systems, strict=True), ("g92", self.g92), ("g28", self.g28),
                              ("g30", self.g30), ("tool_offset", self.tool_offset)):  # fmt: skip
            if len(offsets) != len(_NONE):
                raise ValueError(f"{name} has {len(_NONE)} axes, not {len(offsets)}")

    def placed(self, **axes: float) -> WorkState:
        """Return this state with the origin of the active system at the given axes, like ``placed(X=10.0)``."""
        origin = list(self.systems[self.active - 1])
        for axis, value in axes.items():
            origin[AXES.index(axis)] = value
        systems = [*self.systems]
        systems[self.active - 1] = tuple(origin)
        return replace(self, systems=tuple(systems))
