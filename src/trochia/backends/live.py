"""The seam between the controller and whoever moves the machine now: orders in, reports out.

A live backend holds a queue of segments and runs through it by its own clock.  *Stream time* counts what it has run
through, in seconds of planned motion; it keeps pace with the clock as long as the rate is 1.  A queue that runs low
without ending at rest slows the rate to 0 by itself, as does a lost host; whatever happens, the beam is off then.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar, Protocol, runtime_checkable

from trochia.errors import LocalProtocolError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from trochia.backends.segments import Segments
    from trochia.machine.machine import Machine
    from trochia.messages import Cause

#: outputs every backend has: the spindle [signed rpm], and coolant
BUILT_IN = ("spindle", "flood", "mist")


@dataclass(frozen=True, slots=True, kw_only=True)
class Watch:
    """Brake when an input takes a level; joint positions are caught at that instant."""

    name: str
    level: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Orders:
    """What the controller wants done, all at once; what is None or empty stays as it is.

    Attributes
    ----------
    segments, at
        Motion from stream time ``at`` on; replaces what is queued from there.
    stop
        Stop at once, whatever the limits say; drop the queue.
    enable
        Drives on or off.
    lit
        Whether segments may light the beam.
    outputs
        Values of outputs by name, at once.
    timed
        The same at a stream time: (time [s], name, value), rising.
    watch
        Inputs to brake at; an empty tuple watches nothing.  Once one was caught, segments are dropped until the next
        orders with a ``watch``: they were sent before anyone knew.
    place
        What the joints' present positions are called from now on [mm or degree], by joint; only at rest.
    inputs
        Levels of inputs that are no switches of an axis; only a twin or a simulated chip takes them.
    """

    segments: Segments | None = None
    at: float = 0.0
    stop: bool = False
    enable: bool | None = None
    lit: bool | None = None
    outputs: Mapping[str, float] = field(default_factory=dict[str, float])
    timed: tuple[tuple[float, str, float], ...] = ()
    watch: tuple[Watch, ...] | None = None
    place: Mapping[str, float] = field(default_factory=dict[str, float])
    inputs: Mapping[str, float] = field(default_factory=dict[str, float])


def check_outputs(orders: Orders, known: Mapping[str, float]) -> None:
    """Refuse orders for outputs that a backend does not have.

    Raises
    ------
    LocalProtocolError
        With the names of those that there are.
    """
    for name in (*orders.outputs, *(name for _, name, _ in orders.timed)):
        if name not in known:
            raise LocalProtocolError(f"there is no output {name!r}", hint=f"There are: {', '.join(known)}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """What the backend saw go wrong; ``value`` and ``limit`` in the joint's unit.

    ``text`` says it, where that is more than what the cause says.
    """

    cause: Cause
    joint: str = ""
    value: float | None = None
    limit: float | None = None
    text: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """The state of a backend at one instant.

    Attributes
    ----------
    time
        Of its clock [s].
    executed
        Stream time it has run through [s].
    rate
        Stream time a second of the clock, now.
    queued
        Motion it still holds [s].
    commanded, velocity
        Of the joints (joints,) [mm or degree, and a second].
    encoder, actual
        What encoders say, and where the load is, (joints,); NaN where there is none, None where nobody knows.
    caught
        Joint positions at the instant a watched input took its level, by encoders where there are some, and which;
        None: not yet.
    inputs
        Levels by name: True or False, or the value of an analogue one.
    settable
        Whether inputs can be set: where nothing real is wired to them.
    """

    time: float
    executed: float
    rate: float
    queued: float
    commanded: NDArray[np.float64]
    velocity: NDArray[np.float64]
    encoder: NDArray[np.float64] | None
    actual: NDArray[np.float64] | None
    enabled: bool
    beam: float
    line: int
    inputs: Mapping[str, float]
    outputs: Mapping[str, float]
    troubles: tuple[Trouble, ...] = ()
    caught: tuple[str, NDArray[np.float64]] | None = None
    settable: bool = False

    @property
    def still(self) -> bool:
        """Whether nothing moves and nothing is left to run through."""
        return self.queued <= 0.0 and not self.velocity.any()


@dataclass(frozen=True, slots=True, kw_only=True)
class Ticks:
    """What happened at servo ticks that follow each other, none left out; a backend's report with time in it.

    Attributes
    ----------
    period
        From tick to tick [s].
    executed
        Stream time (ticks,) [s].
    commanded, velocity, encoder, actual
        Of the joints (ticks, joints), as in :class:`Report`; NaN where there is none.
    beam, line
        At each tick (ticks,).
    """

    period: float
    executed: NDArray[np.float64]
    commanded: NDArray[np.float64]
    velocity: NDArray[np.float64]
    encoder: NDArray[np.float64]
    actual: NDArray[np.float64]
    beam: NDArray[np.float32]
    line: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.executed)


@runtime_checkable
class Tapped(Protocol):
    """A backend that can tell of every servo tick.

    Attributes
    ----------
    tap
        Called inside ``poll``, with ticks as they are run through; None: nobody listens.
    """

    tap: Callable[[Ticks], None] | None


@runtime_checkable
class Bounded(Protocol):
    """A backend whose processor and line bound the steps it can make.

    Attributes
    ----------
    bound
        Name of the board, and its baud rate.
    """

    bound: tuple[str, int]


class SegmentBackend(Protocol):
    """Runs through segments, in its own time.

    Attributes
    ----------
    latency
        How long an order takes to act, at most [s]: what lies nearer than that in stream time cannot be replaced.
    ahead
        How much motion it wants to hold [s].
    title
        Who moves, for a person: ``twin``, or which board where.
    """

    kind: ClassVar[str]
    machine: Machine
    latency: float
    ahead: float
    title: str

    def open(self, now: float) -> Report:
        """Connect, and report; nothing moves, drives are off."""
        ...

    def poll(self, now: float) -> Report:
        """Report how things stand at ``now`` [s of the controller's clock]."""
        ...

    def order(self, orders: Orders, now: float) -> None:
        """Take orders.

        Raises
        ------
        LocalProtocolError
            When they cannot be: segments that do not join on, an unknown output, motion without power.
        """
        ...

    def close(self) -> None:
        """Stop, drives off, disconnect."""
        ...
