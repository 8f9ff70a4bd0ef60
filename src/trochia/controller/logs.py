"""Logs of programs that a served machine runs: ``(LOGOPEN, name)``, ``(LOG, text)``.

In: jobs, and the one folder where logs may lie.  Out: files there, each whole, written beside the turns when a job is
over; what could not be written is told.  A name that would lead elsewhere is refused before anything moves.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from trochia.errors import TrochiaError
from trochia.program import Log
from trochia.program.logs import logs_of, write_logs

if TYPE_CHECKING:
    from collections.abc import Iterable
    from concurrent.futures import Future
    from pathlib import Path

    from trochia.controller.controller import Controller
    from trochia.program import Action, Message

NOT_KEPT = "its logs are not kept: no folder was named for them (--logs)"
_PROGRAM = "<program>"  #: in the folder of logs, no program is in the way


class Logs:
    """The logs of one machine's programs.

    Parameters
    ----------
    folder
        Where they lie; None: they are not kept.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self._told: list[Message] = []  # by the job under way: it grows
        self._writer = ThreadPoolExecutor(1, "trochia-logs")
        self._written: list[Future[list[Path]]] = []

    def check(self, actions: Iterable[Action]) -> str:
        """Return what a program's operator is to know of its logs, or nothing.

        Raises
        ------
        ProgramError
            For a file that would lie outside the folder, or be written over what is no log.
        """
        found = [action for action in actions if isinstance(action, Log)]
        if self._folder is None:
            return NOT_KEPT if found else ""
        logs_of(found, self._folder / _PROGRAM, "the folder of logs")
        return ""

    def look(self, it: Controller) -> None:
        """Keep hold of what the job under way has said, and have it written when that job is over; once a turn."""
        job = it.job
        told = [] if job is None else job.doings.told
        if told is not self._told:
            self._end()
            self._told = told
        while self._written and self._written[0].done():
            error = self._written.pop(0).exception()
            if isinstance(error, TrochiaError | OSError):
                it.note("failure", text=str(error))
                it.said = str(error).splitlines()[0]

    def close(self) -> None:
        """Write what is left to be written."""
        self._end()
        self._writer.shutdown()

    def _end(self) -> None:
        """Have the logs of the job before written."""
        found = [action for action in self._told if isinstance(action, Log)]
        self._told = []
        if found and self._folder is not None:
            self._written.append(self._writer.submit(write_logs, found, self._folder / _PROGRAM, "the folder of logs"))
