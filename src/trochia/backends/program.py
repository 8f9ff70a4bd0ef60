"""The seam to a board that plans for itself: lines in, reports of what it has executed out.

Such a board decides on speed and corners alone; what can be asked of it is to take lines, to hold, to go on, to be
quiet.  A program backend never blocks: ``poll`` takes what has come, sends what there is room for, and reports.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, ClassVar, Protocol

from trochia.messages import OverrideStatus

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from trochia.languages.gcode.write import Line
    from trochia.messages import Fault


class Doing(Enum):
    """What a board does."""

    CONNECTING = "connecting"  # it has not been heard yet, or is being asked for its settings
    IDLE = "idle"
    RUN = "run"
    HOLD = "hold"  # braking, or at rest until it is told to go on
    JOG = "jog"
    HOME = "home"
    ALARM = "alarm"  # takes no motion until unlocked or homed
    DOOR = "door"
    CHECK = "check"  # reads lines, moves nothing
    SLEEP = "sleep"
    LOST = "lost"  # nobody hears it


class Order(Enum):
    """What can be asked of a board at any time."""

    HOLD = "hold"
    RESUME = "resume"
    ABORT = "abort"  # hold, and give up at rest: the position stays known
    RESET = "reset"  # give up at once: in motion, the position is lost
    UNLOCK = "unlock"
    HOME = "home"
    JOG_STOP = "jog-stop"
    ACKNOWLEDGE = "acknowledge"  # forget the faults reported


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardReport:
    """The state of a board at one instant.

    Attributes
    ----------
    position, origin
        In machine coordinates, and where the board's work zero lies in them, {axis: mm}; empty until known.
    feed
        Path speed as the board tells it [mm/s].
    line
        Source line up to which everything has been executed; never one that was only sent.
    waiting, outstanding
        Lines not sent yet, and those sent without an answer.
    inputs
        Letters of the inputs that are active, as the board tells them.
    faults
        Kept until acknowledged.
    done
        Whether everything sent has been executed, and nothing moves.
    """

    time: float
    doing: Doing
    position: Mapping[str, float] = field(default_factory=dict[str, float])
    origin: Mapping[str, float] = field(default_factory=dict[str, float])
    feed: float = 0.0
    spindle: float = 0.0
    line: int = 0
    waiting: int = 0
    outstanding: int = 0
    overrides: OverrideStatus = field(default_factory=OverrideStatus)
    inputs: frozenset[str] = frozenset()
    faults: tuple[Fault, ...] = ()
    done: bool = True


class ProgramBackend(Protocol):
    """A board that takes a program line by line."""

    kind: ClassVar[str]

    @property
    def settings(self) -> Mapping[str, str]:
        """What the board says about itself, by its own names; empty until it is connected."""
        ...

    def open(self, now: float) -> BoardReport:
        """Begin to connect, or to connect again; nothing moves.

        Raises
        ------
        LinkError
            When there is no such port.
        """
        ...

    def poll(self, now: float) -> BoardReport:
        """Take what has come, send what there is room for, and report how things stand at ``now`` [s]."""
        ...

    def send(self, lines: Iterable[Line]) -> None:
        """Queue lines; they are sent as the board takes them.

        Raises
        ------
        LocalProtocolError
            When the board is not connected or in alarm, or a line is none it could take.
        """
        ...

    def order(self, order: Order, now: float) -> None:
        """Ask for something now, ahead of all lines.

        Raises
        ------
        LocalProtocolError
            When it cannot be asked for at present.
        """
        ...

    def override(self, *, feed: float = 1.0, rapid: float = 1.0, spindle: float = 1.0) -> None:
        """Scale feed, rapids and spindle, as near as the board can."""
        ...

    def jog(self, way: Mapping[str, float], speed: float) -> None:
        """Move axes by a way [mm] at a speed [mm/s]; refused as ``send`` refuses."""
        ...

    def close(self) -> None:
        """Hold what moves, and disconnect."""
        ...
