"""M100 to M199 as programs of the machine's own: run at rest, waited for, an exit code other than 0 is an alarm.

In: the folder that the machine file names, the controller's status turn by turn.  Out: processes, and the controller's
word to go on.  A program is called as LinuxCNC calls it: its file is named like the code, its arguments are P and Q
with six decimals, -1.000000 where one is not given.  What gives the job up ends the process, too.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import tempfile
from contextlib import suppress
from typing import IO, TYPE_CHECKING

from trochia.backends.live import Trouble
from trochia.controller.job import Job
from trochia.controller.states import State
from trochia.errors import ConfigError
from trochia.messages import Cause
from trochia.messages.command import Resume
from trochia.program import UserCode

if TYPE_CHECKING:
    from pathlib import Path

    from trochia.backends.live import Report
    from trochia.controller.runtime import Runtime
    from trochia.messages import Status

_NAME = re.compile(r"M1[0-9][0-9]\Z")
_MOST_WORDS = 200  #: characters of what a program said last that an alarm repeats
_GRACE = 2.0  #: that a program gets to end by itself once its job is given up [s]


def codes_in(folder: Path) -> frozenset[int]:
    """Return the numbers of the codes whose programs lie in a folder.

    Raises
    ------
    ConfigError
        Where there is no such folder.
    """
    if not folder.is_dir():
        raise ConfigError(f"there is no folder {folder}", key="user_m_codes",
                          hint="It holds the programs of M100 to M199, named M100 to M199.")  # fmt: skip
    return frozenset(int(file.name[1:]) for file in folder.iterdir()
                     if _NAME.match(file.name) and file.is_file() and os.access(file, os.X_OK))  # fmt: skip


class Hooks:
    """The programs of one machine.

    Parameters
    ----------
    folder
        Where they are.
    blocking
        Whether to wait for a program within a turn: for virtual time, of which none is to pass meanwhile.
    """

    def __init__(self, folder: Path, runtime: Runtime, *, blocking: bool = False) -> None:
        self._folder, self._runtime, self._blocking = folder, runtime, blocking
        self._process: subprocess.Popen[bytes] | None = None
        self._said: IO[bytes] | None = None
        self._dying: list[tuple[subprocess.Popen[bytes], float]] = []  # and when they are killed
        self._action: UserCode | None = None  # the one under way, or the last that is done
        runtime.controller.hooked = codes_in(folder)
        runtime.watchers.append(self.look)

    def look(self, status: Status, report: Report) -> None:
        """Start, wait for, or end what the controller's state asks for; called at the end of each turn."""
        del report
        self._bury(status.time)
        controller = self._runtime.controller
        job = controller.activity
        held = isinstance(job, Job) and controller.state is State.HELD
        action = job.waiting if held and isinstance(job, Job) else None
        if not isinstance(action, UserCode) or action.number not in controller.hooked:
            self._give_up(status.time)
            return
        if action is not self._action:
            self._give_up(status.time)
            self._start(action)
        if self._process is None:
            return
        code = self._process.wait() if self._blocking else self._process.poll()
        if code is not None:
            self._process = None
            self._end(action, code)
            self._forget()

    def _start(self, action: UserCode) -> None:
        self._action = action
        arguments = [f"{-1.0 if value is None else value:.6f}" for value in (action.p, action.q)]
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - open until the program ends
        self._runtime.controller.hook = f"M{action.number}"
        try:
            self._process = subprocess.Popen(  # noqa: S603 - the machine file names it
                [self._folder / f"M{action.number}", *arguments], stdin=subprocess.DEVNULL, stdout=self._said,
                stderr=subprocess.STDOUT, cwd=self._folder, start_new_session=True,
            )  # fmt: skip
        except OSError as error:
            self._forget()
            self._fail(action, f"cannot be started: {error.strerror or error}")

    def _end(self, action: UserCode, code: int) -> None:
        """Go on after exit code 0, else raise an alarm."""
        self._runtime.controller.note("hook", text=f"M{action.number}", line=action.line, exit_code=code)
        if code == 0:
            self._runtime.controller.hook = ""
            self._runtime.send(Resume())
            return
        how = f"ended with exit code {code}" if code > 0 else f"was ended by signal {-code}"
        self._fail(action, how + self._last_words())

    def _fail(self, action: UserCode, how: str) -> None:
        controller = self._runtime.controller
        controller.hook = ""
        controller.fault(Trouble(cause=Cause.PROGRAM), f"line {action.line}: M{action.number} {how}")

    def _last_words(self) -> str:
        """Return the last line that the program has said, behind a colon."""
        assert self._said is not None, "a program runs"
        self._said.seek(0)
        lines = [line.strip() for line in self._said.read().decode("utf-8", "replace").splitlines() if line.strip()]
        return f": {lines[-1][:_MOST_WORDS]}" if lines else ""

    def close(self) -> None:
        """End what still runs, and wait for that."""
        self._give_up(0.0)
        for process, _ in self._dying:
            with suppress(subprocess.TimeoutExpired):
                process.wait(_GRACE)
            _signal(process, signal.SIGKILL)
            process.wait()
        self._dying.clear()

    def _give_up(self, now: float) -> None:
        """End the program under way: nobody waits for it any more."""
        self._action = None
        self._runtime.controller.hook = ""
        if self._process is not None:
            _signal(self._process, signal.SIGTERM)
            self._dying.append((self._process, now + _GRACE))
            self._process = None
            self._forget()

    def _forget(self) -> None:
        """Forget what the last program has said."""
        if self._said is not None:
            self._said.close()
            self._said = None

    def _bury(self, now: float) -> None:
        """Take leave of programs that were ended; what does not listen is killed."""
        for process, until in self._dying:
            if now > until:
                _signal(process, signal.SIGKILL)
        self._dying = [(process, until) for process, until in self._dying if process.poll() is None]


def _signal(process: subprocess.Popen[bytes], number: signal.Signals) -> None:
    """Send a signal to a program and all that it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, number)
