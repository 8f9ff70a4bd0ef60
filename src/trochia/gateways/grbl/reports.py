"""What a sender is told: status reports, offsets, alarms by number.  In: Status, work state.  Out: GRBL's lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.messages import Cause
from trochia.program import AXES, SYSTEMS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from trochia.messages import Status
    from trochia.program import WorkState

LETTERS = "XYZ"
#: state of the controller -> what GRBL calls it
STATES = {
    "off": "Sleep", "estop": "Alarm", "alarm": "Alarm", "idle": "Idle", "homing": "Home", "jogging": "Jog",
    "running": "Run", "resuming": "Run", "stepping": "Run", "probing": "Run", "stopping": "Run", "holding": "Hold:1",
    "retracting": "Hold:1",
    "held": "Hold:0",
}  # fmt: skip
#: cause of a fault -> number of GRBL's alarm
ALARMS = {
    Cause.HARD_LIMIT: 1, Cause.SOFT_LIMIT: 2, Cause.PROBE: 5, Cause.HOMING: 9, Cause.DOOR: 2, Cause.PROGRAM: 2,
}  # fmt: skip
OTHER = 3  #: of every fault GRBL has no number for: it stopped, and its position may be lost


def point(values: Sequence[float]) -> str:
    """Return numbers as GRBL writes a position."""
    return ",".join(f"{value + 0.0:.3f}" for value in values)


def offsets(work: WorkState) -> list[str]:
    """Return the lines of ``$#``."""
    lines = [f"[{name}:{point(origin[:3])}]" for name, origin in zip(SYSTEMS[:6], work.systems[:6], strict=True)]
    lines += [f"[G28:{point(work.g28[:3])}]", f"[G30:{point(work.g30[:3])}]", f"[G92:{point(work.g92[:3])}]"]
    return [*lines, f"[TLO:{work.tool_offset[2]:.3f}]", "[PRB:0.000,0.000,0.000:0]"]


def origin_of(work: WorkState, system: int) -> list[float]:
    """Return where the work zero of a system (1: G54) lies (3) [mm]."""
    shift = work.g92 if work.g92_on else (0.0,) * len(AXES)
    return [work.systems[system - 1][at] + shift[at] + work.tool_offset[at] for at in range(len(LETTERS))]


def machine_position(status: Status) -> list[float]:
    """Return the commanded position (3) [mm]; 0 for an axis the machine has not."""
    found = {axis.name: axis.commanded for axis in status.axes}
    return [found.get(letter, 0.0) for letter in LETTERS]


class Reporter:
    """Makes status reports; offsets and overrides stand in every tenth, and in the next after a change."""

    def __init__(self) -> None:
        self.mask = 3  # $10: machine position, buffers
        self._told: dict[str, str] = {}
        self._count = 0

    def line(self, status: Status, name: str, origin: list[float], free: tuple[int, int], number: int) -> str:
        """Return one report.

        Parameters
        ----------
        name
            GRBL's name of the state.
        free
            Free blocks and bytes.
        number
            Number of the line under way; 0: the sender numbers none.
        """
        at = machine_position(status)
        fields = [f"MPos:{point(at)}" if self.mask & 1
                  else f"WPos:{point([a - b for a, b in zip(at, origin, strict=True)])}"]  # fmt: skip
        if self.mask & 2:
            fields.append(f"Bf:{free[0]},{free[1]}")
        if number:
            fields.append(f"Ln:{number}")
        fields.append(f"FS:{60.0 * status.speed:.0f},{abs(status.spindle) or status.beam:.0f}")
        over = status.overrides
        rare = {
            "WCO": point(origin),
            "Ov": ",".join(f"{100.0 * value:.0f}" for value in (over.feed, over.rapid, over.spindle)),
        }
        for key, value in rare.items():
            if self._told.get(key) != value or self._count % 10 == 0:
                fields.append(f"{key}:{value}")
                self._told[key] = value
                if key == "WCO":
                    break  # one of them a report, as GRBL does
        self._count += 1
        return f"<{name}|{'|'.join(fields)}>"
