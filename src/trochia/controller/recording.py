"""A live run recorded: every servo tick, all the time or around what triggers it.

In: ticks of the backend, turn by turn, and the controller's state.  Out: a folder of parts (``recorder/ring.py``).
Files are written by a thread of their own, so that a slow disk never delays a turn; a disk that stays behind by
:data:`BEHIND` blocks ends the recording.
"""

from __future__ import annotations

import threading
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from queue import Empty, Full, Queue
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.backends.live import Tapped
from trochia.backends.live_signals import LiveSignals, ticks_of
from trochia.controller.states import State
from trochia.errors import RecordingError
from trochia.recorder import Header, RingWriter

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from trochia.backends.live import Report, SegmentBackend, Ticks

    Block = Mapping[str, NDArray[Any]]

STATES = tuple(state.value for state in State)
LIMIT = 256 << 20  #: bytes a recording takes at most, unless told otherwise
BEHIND = 4000  #: blocks the disk may be behind: 20 s of turns
WRITTEN = 10  #: turns of a block: 50 ms
_TRIGGERS = {"hold": (State.HOLDING,), "alarm": (State.ALARM, State.ESTOP)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Take:
    """What is to be recorded.

    Attributes
    ----------
    path
        The folder.
    channels
        Names, with ``*`` and ``?`` for any; none: all.
    triggers
        ``hold``, ``alarm``, or ``line N``; none: all the time.
    before, after
        How much around a trigger [s].
    limit
        Bytes it takes at most, the oldest dropped; None: no bound.

    Raises
    ------
    RecordingError
        For a trigger of another name.
    """

    path: Path
    channels: tuple[str, ...] = ()
    triggers: tuple[str, ...] = ()
    before: float = 1.0
    after: float = 1.0
    limit: int | None = LIMIT

    def __post_init__(self) -> None:
        for trigger in self.triggers:
            if trigger not in _TRIGGERS and line_of(trigger) is None:
                raise RecordingError(f"a recording is triggered by hold, alarm or line N, not by {trigger!r}")
        if not (self.before >= 0.0 and self.after >= 0.0):
            raise RecordingError("the times before and after a trigger are zero or more")


def line_of(trigger: str) -> int | None:
    """Return N of a trigger ``line N``, or None."""
    word, _, number = trigger.partition(" ")
    return int(number) if word == "line" and number.isdigit() else None


class Recorder:
    """Records one backend; nothing is done while nothing is to be recorded.

    Attributes
    ----------
    failed
        Why the last recording ended by itself; empty: it did not.
    """

    def __init__(self, backend: SegmentBackend, *, turn: float) -> None:
        self._backend = backend
        self._turn = turn
        self._ticks: list[Ticks] = []
        self._last = 0.0
        self._going: _Going | None = None
        self._ending: _Going | None = None
        self.failed = ""

    @property
    def path(self) -> Path | None:
        """Where it is recording to; None: nowhere."""
        return None if self._going is None else self._going.take.path

    def start(self, take: Take, *, program: str = "") -> None:
        """Record from now on.

        Raises
        ------
        RecordingError
            When it records already or still writes, or the folder or a channel cannot be taken.
        """
        if self._going is not None:
            raise RecordingError(f"it is recording to {self._going.take.path.name} already")
        if self._ending is not None and not self._ending.ended:
            raise RecordingError(f"{self._ending.take.path.name} is still being written")
        machine = self._backend.machine
        signals = LiveSignals(machine, take.channels, STATES)
        tapped = isinstance(self._backend, Tapped)
        header = Header(period=machine.servo_period if tapped else self._turn, machine=machine.name, program=program,
                        channels=signals.channels, origin=f"live {self._backend.kind}, "
                        f"{'every servo tick' if tapped else 'the latest report at each turn'}")  # fmt: skip
        self._going = _Going(take, signals, RingWriter(take.path, header, limit=take.limit), header.period)
        self._ticks.clear()
        self._last, self.failed = -1.0, ""
        if isinstance(self._backend, Tapped):
            self._backend.tap = self._ticks.append

    def stop(self, *, wait: bool = False) -> Path | None:
        """Record no more; return where it is kept, and wait until it is whole there if asked to."""
        going, self._going = self._going, None
        if isinstance(self._backend, Tapped):
            self._backend.tap = None
        if going is not None:
            going.end()
            self._ending = going
        if wait and self._ending is not None:
            self._ending.join()
            self.failed = self._ending.failed
        return None if going is None else going.take.path

    def turn(self, report: Report, state: State) -> str:
        """Take in what has happened since the turn before; return why it has ended by itself, if it has."""
        going = self._going
        if going is None:
            return ""
        if not isinstance(self._backend, Tapped):
            self._repeat(report)
        for ticks in self._ticks:
            going.add(ticks, state)
        self._ticks.clear()
        if going.failed:
            self.stop()
        return going.failed

    def _repeat(self, report: Report) -> None:
        """Make even ticks of a backend's reports."""
        self._last = report.time if self._last < 0.0 else self._last
        count = int((report.time - self._last) / self._turn + 0.5)
        if count > 0:
            self._last += count * self._turn
            self._ticks.append(ticks_of(report, self._turn, count))


class _Going:
    """One recording under way: from ticks to blocks, around triggers or all."""

    def __init__(self, take: Take, signals: LiveSignals, writer: RingWriter, period: float) -> None:
        self.take = take
        self.failed = ""
        self._signals, self._writer = signals, writer
        self._before, self._after = (round(seconds / period) for seconds in (take.before, take.after))
        self._lines = {line for line in map(line_of, take.triggers) if line is not None}
        self._states = {state for trigger in take.triggers for state in _TRIGGERS.get(trigger, ())}
        self._sample = 0  # number of the next
        self._begin = 0  # number of the first that is wanted before a trigger
        self._until = 0  # number of the first that is not wanted any more
        self._kept: deque[tuple[int, Block]] = deque()  # blocks before a trigger that may come
        self._gathered: list[Block] = []
        self._was: tuple[State | None, int] = (None, 0)
        self._queue: Queue[tuple[int, list[Block]] | None] = Queue(BEHIND)
        self._over = False
        self._thread = threading.Thread(target=self._write, name="trochia-recording", daemon=True)
        self._thread.start()

    def add(self, ticks: Ticks, state: State) -> None:
        """Take ticks in."""
        block = self._signals.samples(ticks, STATES.index(state.value))
        first, self._sample = self._sample, self._sample + len(ticks)
        if not self.take.triggers:
            self._gather(first, block)
            return
        at = self._triggered(ticks, state)
        if at is not None:
            self._begin, self._until = first + at - self._before, first + at + self._after + 1
        if first < self._until:
            while self._kept:
                begin, kept = self._kept.popleft()
                skip = max(self._begin - begin, 0)
                self._put(begin + skip, _cut(kept, skip, None))
            skip = max(self._begin - first, 0)
            first, block = first + skip, _cut(block, skip, None)
            self._put(first, _cut(block, 0, self._until - first))
            if self._until >= self._sample:
                return
            block, first = _cut(block, self._until - first, None), self._until
        self._kept.append((first, block))
        while self._kept and self._kept[0][0] + _length(self._kept[0][1]) + self._before < self._sample:
            self._kept.popleft()

    def end(self) -> None:
        """Have what is left written, soon; :meth:`join` waits for it."""
        if self._gathered:
            self._put_all()
        self._over = True
        with suppress(Full):  # then the writer sees that it is over when it has caught up
            self._queue.put_nowait(None)

    @property
    def ended(self) -> bool:
        """Whether everything is written."""
        return not self._thread.is_alive()

    def join(self) -> None:
        """Wait until everything is written."""
        self._thread.join()

    def _triggered(self, ticks: Ticks, state: State) -> int | None:
        """Return the tick at which something triggers, or None."""
        (was, line), self._was = self._was, (state, int(ticks.line[-1]))
        if state is not was and state in self._states:
            return 0
        if not self._lines:
            return None
        moving = ticks.velocity.any(axis=1)
        fresh = np.concatenate([[line], ticks.line[:-1]]) != ticks.line
        wanted = np.isin(ticks.line, list(self._lines)) & fresh & moving
        return int(np.argmax(wanted)) if wanted.any() else None

    def _gather(self, first: int, block: Block) -> None:
        if not self._gathered:
            self._begun = first
        self._gathered.append(block)
        if len(self._gathered) >= WRITTEN:
            self._put_all()

    def _put_all(self) -> None:
        blocks, self._gathered = self._gathered, []
        self._send(self._begun, blocks)

    def _put(self, first: int, block: Block) -> None:
        if _length(block):
            self._send(first, [block])

    def _send(self, first: int, blocks: list[Block]) -> None:
        try:
            self._queue.put_nowait((first, blocks))
        except Full:
            self.failed = self.failed or "the disk is too slow for it"

    def _write(self) -> None:
        """Write blocks as they come, in a thread of its own; when the disk refuses, say so and take no more."""
        try:
            while (work := self._next()) is not None:
                first, blocks = work
                self._writer.write({name: np.concatenate([b[name] for b in blocks]) for name in blocks[0]}, first)
            self._writer.finish()
        except (OSError, RecordingError) as error:
            self.failed = f"{type(error).__name__}: {error}"

    def _next(self) -> tuple[int, list[Block]] | None:
        """Return what is to be written next; None at the end."""
        while True:
            try:
                return self._queue.get(timeout=0.5)
            except Empty:
                if self._over:
                    return None


def _length(block: Block) -> int:
    return len(next(iter(block.values())))


def _cut(block: Block, begin: int, end: int | None) -> Block:
    return {name: samples[begin:end] for name, samples in block.items()}
