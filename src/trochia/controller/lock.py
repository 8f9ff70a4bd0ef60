"""The machine lock: everything runs, and no motion goes out.

In: reports and orders, on their way.  Out: the same, but that motion is run through here, by the clock alone, and the
beam stays dark.  What axes would do is in the report; what they do is in its encoders and real positions, as ever.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.executor import Executor
from trochia.backends.live import Orders

if TYPE_CHECKING:
    from trochia.backends.live import Report


class Lock:
    """The lock of one machine, open at first.

    Parameters
    ----------
    period
        Of a tick [s].
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self._inside: Executor | None = None
        self._now = 0.0
        self._line = 0
        self._velocity = np.zeros(0)
        self._timed: list[tuple[float, str, float]] = []

    @property
    def shut(self) -> bool:
        """Whether no motion goes out."""
        return self._inside is not None

    def shut_at(self, report: Report) -> None:
        """Let no motion out from now on; the machine is at rest."""
        self._inside = Executor(report.commanded, self._period)
        self._inside.executed = report.executed
        self._inside.queue.clear(report.commanded, report.executed)
        self._now, self._velocity, self._raw = report.time, np.zeros(len(report.commanded)), report
        self._timed.clear()

    def open(self, report: Report) -> Report:
        """Let motion out again, and return the backend's own report; what was run through here is forgotten."""
        inside, self._inside = self._inside, None
        return report if inside is None else self._raw

    def seen(self, report: Report) -> Report:
        """Return a report with the motion that is kept in."""
        inside = self._inside
        if inside is None:
            return report
        self._raw = report
        self._run(inside, report.time)
        moving = inside.moving
        inside.queue.forget(inside.executed)
        return replace(
            report, executed=inside.executed, rate=inside.rate if moving else 0.0,
            queued=inside.queue.end - inside.executed if moving else 0.0, commanded=inside.commanded,
            velocity=self._velocity, line=self._line, beam=0.0,
        )  # fmt: skip

    def kept(self, orders: list[Orders]) -> list[Orders]:
        """Return orders without their motion, and with the outputs that are due along it.

        Raises
        ------
        LocalProtocolError
            As a backend does, for segments that do not join on.
        """
        inside = self._inside
        if inside is None:
            return orders
        for order in orders:
            if order.stop or order.enable is False:
                inside.halt()
                self._velocity = np.zeros(len(self._velocity))
                self._timed.clear()
            if order.segments is not None:
                self._timed = [entry for entry in self._timed if entry[0] < order.at]
                inside.add(order.segments, order.at)
            self._timed = sorted([*self._timed, *order.timed])
        out = [replace(order, segments=None, timed=(), lit=None if order.lit is None else False) for order in orders]
        return [*out, *self._due(inside)]

    def _run(self, inside: Executor, now: float) -> None:
        """Run through what a backend would have by now."""
        ticks = int((now - self._now) / self._period + 1e-6)
        self._now += ticks * self._period
        while ticks > 0 and inside.moving:
            told = inside.run(ticks)
            ticks -= told.ticks
            self._velocity, self._line = told.velocity, told.line
        if not inside.moving:
            self._velocity = np.zeros(len(self._velocity))

    def _due(self, inside: Executor) -> list[Orders]:
        """Return outputs whose time has come."""
        due: dict[str, float] = {}
        while self._timed and self._timed[0][0] <= inside.executed + 1e-9:
            _, name, value = self._timed.pop(0)
            due[name] = value
        return [Orders(outputs=due)] if due else []
