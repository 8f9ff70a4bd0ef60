"""Where the controller meets time: the only module here that knows a clock, a thread or a file.

``Runtime.turn(now)`` does everything there is to do at an instant: poll the backend, step the controller, order, write
the journal.  With a virtual clock it is called in a loop; with a real one a thread calls it every ``PERIOD`` seconds.
"""

from __future__ import annotations

import gc
import os
import sys
import threading
import time
import traceback
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

import msgspec

from trochia.backends.compensated import compensated
from trochia.backends.live import Bounded, Orders, Trouble
from trochia.controller.controller import Controller
from trochia.controller.interrupted import draft, interrupted, keep
from trochia.controller.journal import Journal
from trochia.controller.logs import Logs
from trochia.controller.offsets import Keeper, kept_work
from trochia.controller.preparing import Preparer
from trochia.controller.recording import Recorder
from trochia.controller.recording_commands import taken_by
from trochia.errors import LinkError
from trochia.messages import Cause
from trochia.messages.command import Record, RecordStop

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from trochia.backends.live import Report, SegmentBackend
    from trochia.languages.gcode import Reading
    from trochia.messages import Ack, AnyCommand, Status
    from trochia.program import WorkState

PERIOD = 0.005  #: between turns [s]
STATUS = 0.02  #: between statuses, where nothing happens [s]
NICE = -10  #: of the controller's thread, where the system grants it


@dataclass(slots=True)
class Load:
    """How hard the host works: turns, seconds spent in them, and the longest."""

    turns: int = 0
    seconds: float = 0.0
    longest: float = 0.0
    late: float = 0.0  # greatest lateness of a turn
    elapsed: float = 0.0  # since the first turn
    processor: float = 0.0  # time of a core used by the thread


class Runtime:
    """One controller on one backend.

    Parameters
    ----------
    journal
        Folder of the journal; None: nothing is kept.
    recordings
        Folder of the recordings that commands ask for; None: they are refused.
    logs
        Folder of the logs that programs write; None: they are not kept.
    keep
        File in which offsets and variables outlast the controller; None: they do not.
    reading
        How programs are read; None: in the machine's dialect, without folders of subroutines.
    now
        When it begins, of the clock that is used [s].

    Attributes
    ----------
    recorder
        Records every servo tick when it is asked to.
    watchers
        Called at the end of each turn, in its thread, with the status and the backend's report; they must be quick.
    """

    def __init__(
        self, backend: SegmentBackend, *, journal: Path | None = None, recordings: Path | None = None,
        work: WorkState | None = None, keep: Path | None = None, logs: Path | None = None,
        reading: Reading | None = None, now: float = 0.0,
    ) -> None:  # fmt: skip
        bound = backend.bound if isinstance(backend, Bounded) else None
        self.backend = backend = compensated(backend)
        self.controller = Controller(backend.machine, backend.open(now), latency=backend.latency,
                                     ahead=backend.ahead, work=kept_work(keep, work) if keep else work,
                                     reading=reading, title=backend.title)  # fmt: skip
        self.controller.logs = Logs(logs)
        self.controller.readier.bound = bound
        self._keeper = Keeper(keep, self.controller.work) if keep else None
        self.load = Load()
        self.recorder = Recorder(backend, turn=PERIOD)
        self._recordings = recordings
        self._open(journal)
        self._commands: SimpleQueue[tuple[AnyCommand, Future[Ack]]] = SimpleQueue()
        self._preparer = Preparer(self.controller, self._take, self._drafted)
        self._draft = ("", "")  # text of a long program that is on the disk already, and its check sum
        self.watchers: list[Callable[[Status, Report], None]] = []
        self._status = self.controller.status(now)
        self._thread: threading.Thread | None = None
        self._over = threading.Event()
        self._write(now, "begin", {"machine": backend.machine.name, "backend": backend.kind})

    # -- for any thread

    @property
    def status(self) -> Status:
        """The latest status."""
        return self._status

    def send(self, command: AnyCommand) -> Future[Ack]:
        """Have a command taken at the next turn; the future is its answer, set when status and journal show it.

        What needs a long program planned is taken when that is done; the turns go on meanwhile.
        """
        answer: Future[Ack] = Future()
        if self._thread is None or not self._preparer.take(command, answer):
            self._take(command, answer)
        return answer

    def _take(self, command: AnyCommand, answer: Future[Ack]) -> None:
        self._commands.put((command, answer))

    # -- the one that runs it

    def turn(self, now: float) -> Status:
        """Do all there is to do at ``now`` [s], and return the status."""
        controller = self.controller
        try:
            report = self.backend.poll(now)
        except LinkError as error:
            controller.fault(Trouble(cause=Cause.LINK, value=0.0), str(error))
            report = controller.report
        state = controller.state
        failed = self.recorder.turn(report, state)
        if failed:
            controller.note("recording", text=f"ended by itself: {failed}")
        orders = controller.step(now, report)
        answers = self._take_commands(now, orders)
        self._order(orders, now)
        if answers or controller.state is not state or now - self._status.time >= STATUS - PERIOD / 2:
            self._status = self._told(controller.status(now))
        trouble = self._keeper.look(controller.work) if self._keeper is not None else ""
        if trouble:
            controller.note("failure", text=f"offsets are not kept: {trouble}")
        controller.logs.look(controller)
        entries, controller.journal = controller.journal, []
        for kind, data in entries:
            self._write(now, kind, data)
        if self._journal is not None:
            self._journal.flush(now)
        for watcher in self.watchers:
            watcher(self._status, report)
        for answer, ack in answers:
            if answer.set_running_or_notify_cancel():
                answer.set_result(ack)
        return self._status

    def _take_commands(self, now: float, orders: list[Orders]) -> list[tuple[Future[Ack], Ack]]:
        """Take the commands that have come, put what they order behind ``orders``; return their answers."""
        answers: list[tuple[Future[Ack], Ack]] = []
        while True:
            try:
                command, answer = self._commands.get_nowait()
            except Empty:
                return answers
            if isinstance(command, Record | RecordStop):
                ack = taken_by(self.recorder, command, self._recordings, self.controller)
            else:
                ack = self.controller.command(command, now)
                orders += self.controller.orders()
            answers.append((answer, ack))

    def command(self, command: AnyCommand, now: float) -> Ack:
        """Take a command in a turn of its own: for virtual time."""
        answer = self.send(command)
        self.turn(now)
        return answer.result()

    def start(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Run in a thread of its own, by a real clock, before other work of this computer where that is allowed."""
        gc.collect()
        gc.freeze()  # what is there stays: looking through it again and again would make turns late
        sys.setswitchinterval(0.001)  # else who computes keeps the controller waiting for 5 ms, a whole turn
        self._thread = threading.Thread(target=self._run, args=(clock,), name="trochia-controller", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the thread, the machine, the journal."""
        self._over.set()
        if self._thread is not None:
            self._thread.join()
        self.backend.close()
        self.recorder.stop(wait=True)
        self.controller.logs.close()
        self._write(self._status.time, "closed", {})
        if self._journal is not None:
            self._journal.close()

    # -- inside

    def _open(self, folder: Path | None) -> None:
        """Open the journal; a job that it has no end of is offered to be gone on with."""
        self._journal = None
        if folder is None:
            return
        job = interrupted(folder) if folder.exists() else None
        self._journal = Journal(folder)
        self.controller.interrupted = job
        if job is not None and not job.closed:
            text = f"{job.line}, {job.distance:.3f} mm along it"
            self.controller.fault(Trouble(cause=Cause.POWER), text)

    def _order(self, orders: list[Orders], now: float) -> None:
        refused = False
        for order in orders:
            if refused and order.segments is not None:
                continue  # what cannot be ordered is not made up for: motion stops by what the backend holds
            try:
                self.backend.order(order, now)
            except LinkError as error:
                refused = True
                self.controller.fault(Trouble(cause=Cause.LINK), str(error))
        if refused:  # the stop and the dark beam do not wait for the next turn
            stops, self.controller.pending = self.controller.pending, []
            for order in stops:
                with suppress(LinkError):
                    self.backend.order(order, now)

    def _told(self, status: Status) -> Status:
        """Return a status that says what is being planned."""
        name = self._preparer.planning
        return msgspec.structs.replace(status, message=f"planning {name}") if name else status

    def _drafted(self, text: str) -> None:
        """Bring the text of a long program to the disk, beside the turns."""
        if self._journal is not None and self._draft[0] is not text:
            with suppress(OSError):  # its job's beginning will say so
                self._draft = (text, draft(self._journal.folder, text))

    def _write(self, now: float, kind: str, data: dict[str, object]) -> None:
        if self._journal is None:
            return
        if kind == "job":
            text, digest = self._draft
            data["program"] = keep(self._journal.folder, str(data["program"]), digest * (data["program"] is text))
        self._journal.write(kind, now, **data)

    def _safe_turn(self, now: float) -> None:
        """Take a turn; whatever goes wrong in it, the machine is stopped and says so."""
        try:
            self.turn(now)
        except Exception as error:  # noqa: BLE001 - a machine must not go on moving with nobody in charge
            text = f"{type(error).__name__}: {error}"
            self.controller.note("failure", text=text, where=traceback.format_exc())
            self.controller.fault(Trouble(cause=Cause.INTERNAL), text)
            self._order(self.controller.orders(), now)
            self._status = self.controller.status(now)

    def _run(self, clock: Callable[[], float]) -> None:
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)
        due = first = clock()
        used = time.thread_time()
        while not self._over.is_set():
            began = clock()
            self._safe_turn(began)
            spent = clock() - began
            load = self.load
            load.turns, load.seconds = load.turns + 1, load.seconds + spent
            load.longest, load.late = max(load.longest, spent), max(load.late, began - due)
            load.elapsed, load.processor = began - first, time.thread_time() - used
            due = max(due + PERIOD, began)
            self._over.wait(max(due - clock(), 0.0))
