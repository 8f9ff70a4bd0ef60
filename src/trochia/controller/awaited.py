"""An input that M66 reads, or waits for.  In: reports of a machine at rest.  Out: what #5399 gets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.controller.doings import input_of

if TYPE_CHECKING:
    from trochia.backends.live import Report
    from trochia.machine.machine import Machine
    from trochia.program import WaitInput


class Awaited:
    """One M66.

    Attributes
    ----------
    value
        What it got: the input's level (0 or 1) or value, -1 after its time was over; None: nothing yet.

    Raises
    ------
    LocalProtocolError
        When the machine has no such input.
    """

    def __init__(self, asks: WaitInput, machine: Machine) -> None:
        self._asks, self._name = asks, input_of(machine, asks)
        self._since: float | None = None
        self._before = 0.0
        self.value: float | None = None

    def look(self, report: Report) -> float | None:
        """Return the value once there is one; the time runs from the first look on."""
        level = float(report.inputs.get(self._name, 0.0))
        if self._since is None:
            self._since, self._before = report.time, level
        if self._comes_true(level):
            self.value = level
        elif report.time - self._since >= self._asks.timeout:
            self.value = -1.0
        self._before = level
        return self.value

    def _comes_true(self, level: float) -> bool:
        match self._asks.wait:
            case 0:
                return True
            case 1:
                return bool(level) and not self._before
            case 2:
                return bool(self._before) and not level
            case 3:
                return bool(level)
            case _:
                return not level
