"""How a program is read, and what it finds set up: what no program says."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from trochia.program.work import WorkState

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.languages.gcode.answers import Answers
    from trochia.languages.gcode.dialects import Dialect

OnEnd = Callable[[WorkState], None]
OnRemark = Callable[[int, str], None]

MOST_LINES = 10_000_000  #: executed lines after which a program counts as endless


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """How a program is read.

    Attributes
    ----------
    subroutines
        Folders with files that hold subroutines, in the order in which they are looked into.
    most_lines
        How many lines a run may execute.
    work
        Offsets, tools and variables set up on the machine.
    startup
        A line that runs before the program.
    ini
        Values of an ini file by section and name, in capitals.
    dialect
        Whose language the program is in; None: the machine's, or else LinuxCNC's.  Files with subroutines are in
        LinuxCNC's.
    on_remark
        Is given what a dialect's program means otherwise: line and message.
    on_end
        Is given what the program leaves set up, when it has come to its end.
    answers
        What a machine has answered to probing moves and M66 so far; the reading ends at the first question without
        one.  None: nobody answers, and reading goes on as if the machine were not there.
    """

    subroutines: tuple[Path, ...] = ()
    most_lines: int = MOST_LINES
    work: WorkState = field(default_factory=WorkState)
    startup: str = ""
    ini: Mapping[tuple[str, str], str] = field(default_factory=dict[tuple[str, str], str])
    dialect: Dialect | None = None
    on_remark: OnRemark | None = None
    on_end: OnEnd | None = None
    answers: Answers | None = None

    def __post_init__(self) -> None:
        if self.most_lines < 1:
            raise ValueError(f"most_lines must be at least 1, not {self.most_lines}")


USUAL = Reading()  #: no folders, the usual bound
