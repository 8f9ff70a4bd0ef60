"""Tools: what a tool table says of each.  In: a tool file, or a program's G10.  Out: offsets and diameters."""

from __future__ import annotations

from dataclasses import dataclass

Offsets = tuple[float, ...]  #: nine axes, in the order of ``AXES`` [mm, degree]

NO_OFFSET: Offsets = (0.0,) * 9


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """One tool.

    Attributes
    ----------
    number
        What T calls it; 0 is no tool.
    pocket
        Where the changer keeps it.
    offset
        From the spindle's reference to the tool's tip (9) [mm, degree].
    diameter
        Of the cutter [mm].
    front, back
        Angles of a turning tool's edges [degree].
    orientation
        Where a turning tool's edge points: 1 to 9; 0: not said.
    remark
        The rest of its line in the file.
    """

    number: int
    pocket: int = 0
    offset: Offsets = NO_OFFSET
    diameter: float = 0.0
    front: float = 0.0
    back: float = 0.0
    orientation: int = 0
    remark: str = ""

    def __post_init__(self) -> None:
        if len(self.offset) != len(NO_OFFSET):
            raise ValueError(f"a tool's offset has {len(NO_OFFSET)} axes, not {len(self.offset)}")


NO_TOOL = Tool(number=0)
