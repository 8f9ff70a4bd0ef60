"""The board as its status reports show it.  In: reports, one by one; most leave something out.  Out: the whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.grbl.replies import numbers
from trochia.backends.program import Doing
from trochia.messages import OverrideStatus

if TYPE_CHECKING:
    from trochia.backends.grbl.replies import StatusLine

AXES = "XYZ"
INCH = 25.4


class View:
    """What is known of a board.

    Attributes
    ----------
    free
        Free planner blocks; None: the board does not say ($10).
    unit
        Length of what it reports [mm]; inches with $13=1.
    resting
        Whether a hold has come to rest.
    """

    def __init__(self) -> None:
        self.doing = Doing.CONNECTING
        self.resting = False
        self.unit = 1.0
        self.machine: tuple[float, ...] | None = None
        self.offset: tuple[float, ...] | None = None
        self.feed = self.spindle = 0.0
        self.free: int | None = None
        self.overrides = OverrideStatus()
        self.inputs: frozenset[str] = frozenset()

    def take(self, status: StatusLine) -> None:
        """Take a status report."""
        self.doing = status.doing
        self.resting = status.digit == 0 if status.doing in {Doing.HOLD, Doing.DOOR} else True
        fields: dict[str, tuple[float, ...]] = {
            name: numbers(value) or () for name, value in status.fields.items() if name not in {"Pn", "A"}
        }
        if "WCO" in fields:
            self.offset = fields["WCO"]
        if "MPos" in fields:
            self.machine = fields["MPos"]
        elif "WPos" in fields and self.offset is not None:
            self.machine = tuple(map(sum, zip(fields["WPos"], self.offset, strict=False)))
        speeds = (*fields.get("FS", fields.get("F", ())), 0.0)
        if len(speeds) > 1:
            self.feed, self.spindle = speeds[0] / 60.0, speeds[1]
        self.free = next((int(value) for value in fields.get("Bf", ())[:1]), None)
        if len(fields.get("Ov", ())) == len(AXES):
            feed, rapid, spindle = (value / 100.0 for value in fields["Ov"])
            self.overrides = OverrideStatus(feed=feed, rapid=rapid, spindle=spindle)
        self.inputs = frozenset(status.fields.get("Pn", ""))

    def position(self) -> dict[str, float]:
        """Return the machine position, {axis: mm}; empty until it is known."""
        return _named(self.machine, self.unit)

    def origin(self) -> dict[str, float]:
        """Return where the work zero lies in machine coordinates, {axis: mm}; empty until it is known."""
        return _named(self.offset, self.unit)


def _named(values: tuple[float, ...] | None, unit: float) -> dict[str, float]:
    return {axis: value * unit for axis, value in zip(AXES, values or (), strict=False)}
