"""Offsets, points and variables that outlast the controller: a parameter file, written whole or not at all.

In: a work state whenever it changes.  Out: the file, in LinuxCNC's ``.var`` format; and a work state from it at the
next start.  The tool in the spindle is not in it: whoever starts a machine looks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.files import write_whole
from trochia.program import WorkState
from trochia.program.parameter_file import read_variables, variables_of, work_from, write_variables

if TYPE_CHECKING:
    from pathlib import Path

NAME = "parameters.var"  #: of the file beside a journal


def kept_work(path: Path, work: WorkState | None = None) -> WorkState:
    """Return a work state with what a file says; ``work`` as it is where there is no file yet.

    Raises
    ------
    ConfigError
        For a file that is damaged.
    OSError
        When it cannot be read.
    """
    work = work or WorkState()
    if not path.exists():
        return work
    return work_from(read_variables(path.read_text("latin-1"), str(path)), work, unit=work.unit)


class Keeper:
    """Keeps the work state of one machine.

    Parameters
    ----------
    path
        Of the file.
    work
        As it is at the start, which needs no writing.
    """

    def __init__(self, path: Path, work: WorkState) -> None:
        self._path, self._work = path, work

    def look(self, work: WorkState) -> str:
        """Write a work state that is another than the last; return why it could not be, or nothing."""
        if work is self._work:
            return ""
        before, self._work = self._work, work
        if variables_of(before) == variables_of(work):
            return ""
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self._path, write_variables(variables_of(work, unit=work.unit)).encode())
        except OSError as error:
            return f"{self._path}: {error.strerror or error}"
        return ""
