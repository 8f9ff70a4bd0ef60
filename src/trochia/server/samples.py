"""The last seconds of every turn, as numbers.  In: the backend's reports.  Out: binary frames of what is new."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.controller.status import axes_of
from trochia.messages import pack

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.backends.live import Report
    from trochia.machine.machine import Machine

KEPT = 1000  #: rows: five seconds of turns


class Samples:
    """A ring of rows: time; position and velocity commanded and real position of each axis; rate, beam; line.

    Nothing is kept while nobody looks.

    Attributes
    ----------
    names
        Of the values of a row.
    lookers
        How many want them.
    """

    def __init__(self, machine: Machine) -> None:
        axes = [axis.name for axis in machine.axes]
        kinds = ("commanded", "velocity", "actual")
        self.names = [f"{axis}.{kind}" for kind in kinds for axis in axes] + ["rate", "beam"]
        self.lookers = 0
        self._machine = machine
        self._lock = threading.Lock()
        self._time = np.zeros(KEPT)
        self._values = np.zeros((KEPT, len(self.names)), np.float32)
        self._lines = np.zeros(KEPT, np.uint32)
        self._count = 0

    @property
    def count(self) -> int:
        """How many rows there have been."""
        return self._count

    def add(self, report: Report) -> None:
        """Keep a row; called by the controller's thread."""
        if not self.lookers:
            return
        real = report.commanded * np.nan if report.actual is None else report.actual
        parts = [axes_of(self._machine, joints) for joints in (report.commanded, report.velocity, real)]
        row = np.concatenate([*parts, [report.rate, report.beam]])
        with self._lock:
            if report.time == self._time[self._count % KEPT - 1]:
                return  # less than a servo tick has passed
            i = self._count % KEPT
            self._time[i], self._values[i], self._lines[i] = report.time, row, report.line
            self._count += 1

    def frame(self, since: int) -> tuple[bytes, int]:
        """Return a frame of the rows from number ``since`` on, as far as they are still there, and the next number."""
        with self._lock:
            first = max(since, self._count - KEPT)
            rows = np.arange(first, self._count) % KEPT
            columns: dict[str, NDArray[Any]] = {
                "time": self._time[rows], "values": self._values[rows], "lines": self._lines[rows],
            }  # fmt: skip
            end = self._count
        return pack("samples", columns, first=first, names=self.names), end
