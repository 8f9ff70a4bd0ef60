"""Faults that are latched until someone has taken note of them.

In: troubles as a backend or the controller sees them.  Out: faults with their sentence and remedy, each once, kept
until acknowledged; one whose cause is still there comes back.  The table :data:`TROUBLES` has a row a cause.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from trochia.messages import Cause, Fault

if TYPE_CHECKING:
    from trochia.backends.live import Trouble


class Row(NamedTuple):
    """What a cause means: the sentence (with axis, value, limit and unit to fill in), the remedy, what it does.

    ``at_once``: motion stops without a ramp; ``trusted``: positions are still known afterwards; ``dark``: drives off.
    """

    sentence: str
    remedy: str
    at_once: bool = False
    trusted: bool = True
    dark: bool = False
    warning: bool = False


TROUBLES: dict[Cause, Row] = {
    Cause.FOLLOWING_WARNING: Row(
        "{axis} lags its command by {value:.4g} {unit}, warning above {limit:.4g} {unit}",
        "Slow the feed, or look for friction and load; the loop's gains may be low.", warning=True,
    ),
    Cause.FOLLOWING: Row(
        "{axis} lags its command by {value:.4g} {unit}, more than {limit:.4g} {unit}",
        "Look for what holds the axis, then home it again.", at_once=True, trusted=False, dark=True,
    ),
    Cause.SOFT_LIMIT: Row(
        "{axis} would leave its travel at {value:.4g} {unit}, which ends at {limit:.4g} {unit}",
        "Move the work offset, or the part, or jog back.",
    ),
    Cause.HARD_LIMIT: Row(
        "{axis} has run onto its limit switch at {value:.4g} {unit}",
        "Jog away from the switch; home the axis again if its position may have been lost.", at_once=True,
    ),
    Cause.LINK: Row(
        "the link to the backend failed: {text}",
        "Look at the cable and the supply; a board that is back is connected to by itself.  What it held was braked: "
        "then acknowledge, switch the drives on, and home.", trusted=False,
    ),
    Cause.UNDERRUN: Row(
        "motion ran out while moving, and was stopped along its path",
        "The host was too slow or the link too thin: close other programs, or raise the baud rate.", at_once=True,
    ),
    Cause.DRIVE: Row(
        "the drive of {axis} reports a fault",
        "Read the drive's own code, mend the cause, switch its supply off and on.", at_once=True, trusted=False,
        dark=True,
    ),
    Cause.OVER_SPEED: Row(
        "{axis} ran at {value:.4g} {unit}/s, {limit:.4g} {unit}/s are allowed",
        "Look at the encoder and its wiring: a loop that runs away looks like this.", at_once=True, trusted=False,
        dark=True,
    ),
    Cause.ESTOP: Row(
        "emergency stop", "Release the button, reset, switch the drives on and home.", at_once=True, trusted=False,
        dark=True,
    ),
    Cause.DOOR: Row("{text}", "Close what is open, then acknowledge."),
    Cause.HOMING: Row("homing {axis} failed: {text}", "Look at the switch, its wiring and the machine file's homing."),
    Cause.PROBE: Row("probing failed: {text}", "Look at the probe and the way it was given."),
    Cause.PROGRAM: Row("the program cannot go on: {text}", "Mend the line named, then run from it."),
    Cause.INTERNAL: Row(
        "the controller failed: {text}", "Keep the journal and report it; then acknowledge, and home.", at_once=True,
        trusted=False, dark=True,
    ),
    Cause.POWER: Row(
        "the controller was not closed down: line {text} was executed last",
        "Home the machine; then run-from offers to go on from there.", trusted=False,
    ),
}  # fmt: skip


@dataclass(slots=True)
class Alarms:
    """The faults of one machine, newest last."""

    latched: list[Fault] = field(default_factory=list[Fault])

    def __bool__(self) -> bool:
        """Whether something other than a warning is latched."""
        return any(not fault.warning for fault in self.latched)

    def raise_(self, trouble: Trouble, time: float, *, line: int = 0, unit: str = "", text: str = "") -> Fault | None:
        """Latch a trouble; None when the same cause of the same joint is latched already."""
        if any(fault.cause is trouble.cause and fault.axis == trouble.joint for fault in self.latched):
            return None
        row = TROUBLES[trouble.cause]
        text = text or trouble.text
        sentence = "{text}" if trouble.text and "{text}" not in row.sentence else row.sentence
        fault = Fault(
            cause=trouble.cause, time=time, axis=trouble.joint, value=trouble.value, limit=trouble.limit, unit=unit,
            line=line, warning=row.warning, remedy=row.remedy,
            message=sentence.format(axis=trouble.joint or "an axis", value=trouble.value or 0.0,
                                        limit=trouble.limit or 0.0, unit=unit, text=text, line=line),
        )  # fmt: skip
        self.latched.append(fault)
        return fault

    def acknowledge(self) -> None:
        """Forget all faults; what is still wrong is seen again at the next report."""
        self.latched.clear()
