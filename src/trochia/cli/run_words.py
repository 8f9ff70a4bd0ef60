"""What a program says while it runs: printed as it says it, its logs written when it is over.

In: a runtime.  Out: lines on standard error; files beside the program.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.cli.job import show_messages
from trochia.controller.job import Job
from trochia.program.logs import write_logs

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.backends.live import Report
    from trochia.controller.runtime import Runtime
    from trochia.messages import Status
    from trochia.program import Message


class Words:
    """The words of the one program that a runtime runs."""

    def __init__(self, runtime: Runtime) -> None:
        self._runtime = runtime
        self._told: list[Message] = []
        self._shown = 0
        runtime.watchers.append(self._look)

    def _look(self, status: Status, report: Report) -> None:
        """Keep hold of the job's list, which grows while it runs; in the controller's thread."""
        del status, report
        job = self._runtime.controller.activity
        if isinstance(job, Job):
            self._told = job.doings.told

    def show(self) -> None:
        """Print what has not been printed yet."""
        fresh = self._told[self._shown :]
        self._shown += len(fresh)
        show_messages(fresh)

    def write_logs(self, program: Path) -> list[Path]:
        """Write the logs of what has been executed; return the files.

        Raises
        ------
        ProgramError
            Where they cannot be written.
        """
        return write_logs(self._told, program)
