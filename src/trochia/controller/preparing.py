"""Long programs are read and planned beside the controller's turns, not in one of them.

In: a command that needs the plan of a long program, from any thread.  Out: the same command, passed on to the turns
once that plan lies where they look for it.  What stops the machine ends a start that is not passed on yet: nothing
begins to move after a stop.
"""

from __future__ import annotations

import threading
from collections import deque
from concurrent.futures import TimeoutError as NotYet
from contextlib import suppress
from typing import TYPE_CHECKING

from trochia.controller.starting import known
from trochia.controller.states import TABLE
from trochia.messages import Ack
from trochia.messages.command import Abort, Disable, EmergencyStop, Hold, Load, Run, RunFrom, Step, Unload

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Future

    from trochia.controller.controller import Controller
    from trochia.messages import AnyCommand

LONG = 200_000  #: characters of a program that is not planned within a turn: some 10 ms
JUDGED = 200  #: the same where a board is asked whether it can do it
_STARTS = Run | Step
_PROGRAM = Load | Unload | Run | RunFrom | Step  #: commands that stay in their order
_STOPS = EmergencyStop | Abort | Hold | Disable
_TRIES = 3  #: where the machine was moved meanwhile; then the turn plans
_ANSWERED = 1.0  #: that a turn gets to answer what was passed on, before the next command is looked at [s]


class Preparer:
    """Plans long programs in a thread of its own.

    Parameters
    ----------
    passed
        Takes a command and its answer to the turns.
    drafted
        Is given the text of a long program once it is planned.
    """

    def __init__(
        self, controller: Controller, passed: Callable[[AnyCommand, Future[Ack]], None],
        drafted: Callable[[str], None],
    ) -> None:  # fmt: skip
        self._controller, self._passed, self._drafted = controller, passed, drafted
        self._waiting: deque[tuple[AnyCommand, Future[Ack], int]] = deque()
        self._stops = 0  # how often the machine was told to stop
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    @property
    def planning(self) -> str:
        """Name of the program that is being planned; empty where none is."""
        with self._lock:
            if not self._waiting:
                return ""
            command = self._waiting[0][0]
        return self._text(command)[0]

    def take(self, command: AnyCommand, answer: Future[Ack]) -> bool:
        """Take a command that is to be prepared first, or stands behind one; False: it goes to the turns at once."""
        with self._lock:
            if isinstance(command, _STOPS):
                self._stops += 1
            if not isinstance(command, _PROGRAM) or not (self._waiting or self._long(command)):
                return False
            self._waiting.append((command, answer, self._stops))
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="trochia-planner", daemon=True)
                self._thread.start()
            return True

    def _long(self, command: AnyCommand) -> bool:
        """Whether a command needs a long program planned that is not planned yet, and the state allows it."""
        it = self._controller
        if (it.state, str(type(command).__struct_config__.tag)) not in TABLE or it.activity is not None:
            return False
        if not isinstance(command, Load | _STARTS):
            return False
        name, text = self._text(command)
        return len(text) >= (LONG if it.readier.bound is None else JUDGED) and not it.readier.knows(
            text, name, work=it.work, at=it.position(), block_delete=it.switches.block_delete, exact=_exact(it, command)
        )

    def _work(self) -> None:
        """Prepare and pass on what waits, one command after the other; end when nothing does."""
        while True:
            with self._lock:
                if not self._waiting:
                    self._thread = None
                    return
                command, answer, stops = self._waiting[0]
            for _ in range(_TRIES):
                if not self._long(command) or not self._prepare(command):
                    break
            with self._lock:
                late = isinstance(command, _STARTS | RunFrom) and stops != self._stops
                if not late:
                    self._passed(command, answer)
            if late and answer.set_running_or_notify_cancel():
                answer.set_result(Ack(id=command.id, ok=False, reason="stopped before it began"))
            with suppress(NotYet):
                answer.exception(_ANSWERED)  # a start behind a load is looked at when that is loaded
            with self._lock:
                self._waiting.popleft()

    def _prepare(self, command: AnyCommand) -> bool:
        """Have a command's program planned, or its fault found; return whether there is a plan."""
        it = self._controller
        name, text = self._text(command)
        planned = it.readier.prepare(text, name, work=it.work, at=it.position(), exact=_exact(it, command),
                                     block_delete=it.switches.block_delete, bounded=known(it))  # fmt: skip
        if planned:
            self._drafted(text)
        return planned

    def _text(self, command: AnyCommand) -> tuple[str, str]:
        """Return name and text of the program that a command is about."""
        return (command.name, command.text) if isinstance(command, Load) else self._controller.loaded or ("", "")


def _exact(it: Controller, command: AnyCommand) -> bool:
    return isinstance(command, Step) or (isinstance(command, Run) and it.switches.single_block)
