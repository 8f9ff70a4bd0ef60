"""A job that did not come to its end: what the journal says of it.

In: a journal's folder.  Out: the program as it was (kept beside the journal under its check sum), where it began, the
last point that was executed.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.controller.answer_entries import answer_of
from trochia.controller.journal import entries
from trochia.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from trochia.languages.gcode.answers import Answer
    from trochia.program import WorkState

PROGRAMS = "programs"  #: folder of program texts, inside the journal's
KEPT = 20  #: texts that are kept, at most
_WORK = ("systems", "rotations", "active", "g92", "g92_on", "g28", "g30", "tool", "tool_offset", "unit")


@dataclass(frozen=True, slots=True, kw_only=True)
class Interrupted:
    """A job that was begun and not ended.

    Attributes
    ----------
    name, text
        Of the program; an empty text where it could not be kept.
    start
        Where the machine stood at its beginning, by axis.
    line, distance
        Executed last: source line, and way along it [mm].
    move, position
        The same as the number of the move, and where the axes were.
    done_s
        Time of the motion then [s].
    work
        What it found set up, as :func:`work_entry` gives it.
    answers
        What the machine had answered to its questions.
    closed
        Whether the controller was closed down in good order afterwards.
    """

    name: str
    text: str
    start: dict[str, float]
    work: dict[str, Any]
    block_delete: bool = False
    line: int = 0
    distance: float = 0.0
    move: int = 0
    position: dict[str, float]
    done_s: float = 0.0
    answers: tuple[Answer, ...] = ()
    closed: bool = False

    def place(self, axes: str) -> NDArray[np.float64]:
        """Return the last executed position as an array by letters."""
        return np.array([self.position.get(letter, 0.0) for letter in axes])

    def set_up(self, work: WorkState) -> WorkState:
        """Return a work state with what the job found set up."""
        known = {name: self.work[name] for name in _WORK if name in self.work}
        known |= {name: tuple(map(tuple, known[name])) if name == "systems" else tuple(known[name])
                  for name in known if isinstance(known[name], list)}  # fmt: skip
        variables = {int(number): float(value) for number, value in self.work.get("variables", {}).items()}
        return replace(work, **known, variables=variables)


def work_entry(work: WorkState) -> dict[str, Any]:
    """Return a work state for the journal; the tool table is not among it."""
    kept = {name: getattr(work, name) for name in _WORK}
    return kept | {"variables": {str(number): value for number, value in work.variables.items()}}


def draft(folder: Path, text: str) -> str:
    """Write a program's text to the disk for :func:`keep` to take, and return its check sum; there is one draft.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    data = text.encode("latin-1", errors="replace")
    digest = hashlib.sha256(data).hexdigest()
    path = folder / PROGRAMS / f"{digest}.ngc"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        for other in path.parent.glob("*.part"):
            other.unlink(missing_ok=True)
        with path.with_suffix(".part").open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
    return digest


def keep(folder: Path, text: str, digest: str = "") -> str:
    """Keep a program's text on the disk, and return its check sum; the oldest beyond :data:`KEPT` are dropped.

    Parameters
    ----------
    digest
        What :func:`draft` returned for that text; empty: there is no draft of it.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    digest = digest or draft(folder, text)
    path = folder / PROGRAMS / f"{digest}.ngc"
    if not path.exists():
        if not path.with_suffix(".part").exists():
            draft(folder, text)
        path.with_suffix(".part").replace(path)
        old = sorted(path.parent.glob("*.ngc"), key=lambda kept: kept.stat().st_mtime)
        for spare in old[:-KEPT]:
            spare.unlink()
    return digest


def interrupted(folder: Path) -> Interrupted | None:
    """Return the last job of a journal, if it did not come to its end; None otherwise.

    Raises
    ------
    RecordingError
        When the journal is of a newer version.
    """
    job: dict[str, Any] | None = None
    point: Mapping[str, Any] = {}
    closed = False
    answers: list[Answer] = []
    for entry in entries(folder):
        match entry["kind"]:
            case "job":
                job, point, closed = entry, {}, False
                answers = []
            case "answer":
                answers.append(answer_of(entry))
            case "point" if "move" in entry:
                point = entry
            case "end" if job is not None and entry.get("name") == job["name"]:
                job = None if entry["whole"] else job
            case "closed":
                closed = True
            case _:
                pass
    if job is None:
        return None
    return Interrupted(
        name=job["name"], text=_text(folder, job["program"]), start=job["start"], work=job["work"],
        block_delete=job.get("block_delete", False), line=point.get("line", 0), distance=point.get("distance", 0.0),
        move=point.get("move", 0), position=point.get("position", job["start"]), done_s=point.get("done_s", 0.0),
        answers=tuple(answers), closed=closed,
    )  # fmt: skip


def _text(folder: Path, digest: str) -> str:
    """Return a program that was kept; empty when it is missing or damaged."""
    try:
        data = (folder / PROGRAMS / f"{digest}.ngc").read_bytes()
    except OSError:
        return ""
    if hashlib.sha256(data).hexdigest() != digest:
        raise RecordingError(f"the program kept as {digest[:12]}… is damaged")
    return data.decode("latin-1")
