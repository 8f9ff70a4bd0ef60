"""A problem: what is wrong with a program on a machine, where, and how bad; data for scripts and the report."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.errors import TrochiaError


class Severity(Enum):
    """An error stops the program from running; a warning does not; a note only tells."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One problem; line and column count from 1, 0 means the whole file or line."""

    severity: Severity
    code: str
    file: str
    line: int
    message: str
    column: int = 0
    text: str | None = None
    hint: str | None = None

    def __str__(self) -> str:
        """Return the report as the command line prints it: place, message, line with caret, remedy."""
        place = ":".join([self.file, *(str(n) for n in (self.line, self.column) if n)])
        lines = [f"{self.severity.value}: {place}: {self.message}"]
        if self.text is not None:
            lines.append("    " + self.text.rstrip("\r\n").replace("\t", " "))
            if self.column:
                lines.append("    " + " " * (self.column - 1) + "^")
        if self.hint:
            lines.append(f"  {self.hint}")
        return "\n".join(lines)

    def figures(self) -> dict[str, str | int]:
        """Return what a script gets: severity, code, file, line, column, message."""
        return {
            "severity": self.severity.value,
            "code": self.code,
            "file": self.file,
            "line": self.line,
            "column": self.column,
            "message": self.message,
        }


def more_lines(lines: NDArray[np.uint32]) -> str:
    """Return " (and on 3 more lines)" for the different lines beyond the first, or nothing."""
    others = np.count_nonzero(np.bincount(lines)) - 1  # not np.unique: a million lines are counted faster than sorted
    return f" (and on {others} more line{'s' if others > 1 else ''})" if others > 0 else ""


def from_error(error: TrochiaError, file: str) -> Problem:
    """Return the problem an exception reports."""
    source = error.source
    return Problem(
        severity=Severity.ERROR,
        code=error.code,
        file=source.file if source else file,
        line=source.line if source else 0,
        column=source.column if source else 0,
        message=error.message,
        text=error.text,
        hint=error.hint,
    )
