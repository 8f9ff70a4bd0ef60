"""What a run in real time asked of the host: printed at its end, so that nobody has to guess.

In: the runtime, from before the program starts.  Out: figures; :data:`KEYS` says what each is.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from trochia.messages import Cause

if TYPE_CHECKING:
    from trochia.backends.live import Report
    from trochia.controller.runtime import Runtime
    from trochia.messages import Status

#: key -> how it is told to a person
KEYS = {
    "underruns": "{:.0f} underruns",
    "processor_percent": "{:.1f} % of a core",
    "longest_turn_ms": "longest turn {:.1f} ms",
    "latest_turn_ms": "a turn at most {:.1f} ms late",
    "least_queued_ms": "at least {:.0f} ms of motion queued",
    "command_to_motion_ms": "{:.1f} ms from the command to motion",
}


class Figures:
    """The figures of one run."""

    def __init__(self, runtime: Runtime) -> None:
        self._runtime = runtime
        self._asked: float | None = None
        self._moved: float | None = None
        self._least = float("inf")
        self._underruns: set[float] = set()
        runtime.watchers.append(self._look)

    def begin(self) -> None:
        """Note that the program is asked for now."""
        self._asked, self._moved = time.monotonic(), None

    def _look(self, status: Status, report: Report) -> None:
        """Watch a turn."""
        moving = bool(report.velocity.any())
        if self._asked is not None and self._moved is None and moving:
            self._moved = time.monotonic()
        if moving and status.state == "running" and report.queued and (status.program is None or _far(status)):
            self._least = min(self._least, report.queued)
        self._underruns |= {alarm.time for alarm in status.alarms if alarm.cause is Cause.UNDERRUN}

    def told(self) -> dict[str, float | None]:
        """Return the figures; None where nothing was to be measured."""
        load = self._runtime.load
        latency = None if self._asked is None or self._moved is None else 1000.0 * (self._moved - self._asked)
        return {
            "underruns": float(len(self._underruns)),
            "processor_percent": 100.0 * load.processor / load.elapsed if load.elapsed else None,
            "longest_turn_ms": 1000.0 * load.longest,
            "latest_turn_ms": 1000.0 * load.late,
            "least_queued_ms": 1000.0 * self._least if self._least < float("inf") else None,
            "command_to_motion_ms": latency,
        }

    def sentence(self) -> str:
        """Return them as a person reads them."""
        return ", ".join(KEYS[key].format(value) for key, value in self.told().items() if value is not None)


def _far(status: Status) -> bool:
    """Whether a program is not about to end: what is queued shrinks then by itself."""
    return status.program is not None and status.program.remaining_s > 1.0
