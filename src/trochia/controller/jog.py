"""Moves by hand: as long as a lease lives, or to a place.

In: a straight plan.  Out: orders, like any motion's; a jog whose lease has run out brakes as one that is held does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trochia.backends.live import Orders
from trochia.controller.feeder import Feeder
from trochia.controller.states import Event
from trochia.planner.live import LivePlan

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.analysis.plan import Plan
    from trochia.backends.live import Report
    from trochia.machine.machine import Machine


class Jog:
    """One straight move.

    Parameters
    ----------
    lease
        (axis, signed speed, seconds) of a jog that lives by renewal; None: it goes to its end.
    now
        When it was asked for [s].
    """

    def __init__(
        self, plan: Plan, machine: Machine, *, origin: float, ahead: float, now: float,
        lease: tuple[str, float, float] | None = None,
    ) -> None:  # fmt: skip
        self.feeder = Feeder(LivePlan.of(plan.trajectory, machine), machine, origin=origin, ahead=ahead)
        self._lease = lease
        self._until = now + lease[2] if lease else 0.0
        self._braking = False

    def renew(self, axis: str, speed: float, lease: float, now: float) -> bool:
        """Let the lease live on; False when the same jog is not what is asked for."""
        if self._lease is None or self._braking or (axis, speed > 0.0) != (self._lease[0], self._lease[1] > 0.0):
            return False
        self._until = now + lease
        return True

    def expired(self, now: float) -> bool:
        """Whether the lease has run out and nothing brakes yet."""
        return self._lease is not None and not self._braking and now >= self._until

    def feed(self, report: Report) -> Iterator[Orders]:
        """Yield the next orders."""
        for segments, at, _ in self.feeder.more(report.executed, lambda _: None):
            yield Orders(segments=segments, at=at)

    def event(self, report: Report) -> Event | None:
        """Return STILL at the end."""
        return Event.STILL if self.feeder.done(report.executed) else None

    def hold(self, report: Report, latency: float) -> None:
        """Brake as soon as an order can act."""
        self._braking = True
        self.feeder.brake(report.executed, latency)

    def finish(self, *, whole: bool) -> Orders:  # noqa: ARG002 - of the protocol
        """Return nothing: a jog sets nothing."""
        return Orders()
