"""Outputs that change by themselves: those that go back after a time, and those that follow an input.

In: reports.  Out: what to set.  Both are looked at every turn, so a time is kept to a turn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trochia.backends.live import Report
    from trochia.machine.machine import Machine


class Outputs:
    """The outputs of one machine that have a rule."""

    def __init__(self, machine: Machine) -> None:
        self._times = {c.name: c.duration for c in machine.io if c.kind == "timed" and c.duration is not None}
        self._follows = {c.name: c.follows for c in machine.io if c.follows is not None}
        self._since: dict[str, float] = {}  # when a timed output was seen on first

    def due(self, report: Report) -> dict[str, float]:
        """Return the outputs to set now, by name."""
        due: dict[str, float] = {}
        for name, duration in self._times.items():
            if not report.outputs.get(name):
                self._since.pop(name, None)
            elif report.time - self._since.setdefault(name, report.time) >= duration - 1e-9:
                due[name] = 0.0
        for name, followed in self._follows.items():
            level = float(report.inputs.get(followed, 0.0))
            if report.outputs.get(name) != level:
                due[name] = level
        return due
