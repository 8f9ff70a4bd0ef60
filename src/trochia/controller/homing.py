"""Homing as an activity: the legs of a search are planned and run, one at a time.

In: axes.  Out: orders; positions are named where the switch was caught, and trusted from then on.  What the legs are is
in ``search.py``; here each is planned, fed to the backend, and over when it is at rest.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import Orders
from trochia.controller.feeder import Feeder
from trochia.controller.placement import placement
from trochia.controller.search import Leg, NotFoundError, Search, index_pulse, squared
from trochia.controller.states import Event
from trochia.controller.status import axes_of
from trochia.errors import LocalProtocolError
from trochia.planner.live import LivePlan

if TYPE_CHECKING:
    from collections.abc import Iterator

    from trochia.backends.live import Report
    from trochia.backends.segments import Segments
    from trochia.controller.controller import Controller
    from trochia.machine.axes import Axis


class Home:
    """Homing of some axes.

    Raises
    ------
    LocalProtocolError
        When an axis has no way home that this backend can go.
    """

    def __init__(self, it: Controller, axes: tuple[Axis, ...]) -> None:
        for axis in axes:
            index = index_pulse(it.machine, axis)
            if index and index[0] not in it.report.inputs:
                raise LocalProtocolError(f"{axis.name} is homed to an encoder's index, which this backend cannot catch",
                                         hint="Home it to its switch: home.method in the machine file.")  # fmt: skip
            wrong = next(placement(axis, index[1] if index else 0.0), None)
            if wrong is not None:
                raise LocalProtocolError(f"{axis.name} cannot be homed safely: {wrong}",
                                         hint="Move the switch, or lower the speed of the search.")  # fmt: skip
        self._it = it
        self._pending: list[Orders] = []
        self._script = Search(it, self._pending.append).all(axes)
        self._leg: Leg | None = None
        self._base = it.report.commanded.copy()  # of the joints, where the leg under way began
        self._feeder: Feeder | None = None
        self._over = self._braking = False
        self._advance()

    # -- as an activity

    def feed(self, report: Report) -> Iterator[Orders]:
        """Yield the next orders; none once the switch was caught."""
        orders = self._pending.copy()
        self._pending.clear()
        yield from orders
        if self._feeder is not None and report.caught is None:
            for segments, at, _ in self._feeder.more(report.executed, lambda _: None):
                yield Orders(segments=self._moved_from(segments), at=at)

    def event(self, report: Report) -> Event | None:
        """Return STILL when all is done; between legs go on with the next."""
        if self._pending:
            return None
        still = report.still and (report.caught is not None or self._feeder is None
                                  or self._feeder.done(report.executed))  # fmt: skip
        if still and not self._over and not self._braking:
            self._advance()
        return Event.STILL if still and (self._over or self._braking) else None

    def hold(self, report: Report, latency: float) -> None:
        """Brake; the search is given up."""
        self._braking = True
        if self._feeder is not None and report.caught is None:
            self._feeder.brake(report.executed, latency)

    def finish(self, *, whole: bool) -> Orders:  # noqa: ARG002 - of the protocol
        """Watch nothing any more; joints of a gantry that stand apart are called as if they did not."""
        return Orders(watch=(), place=squared(self._it.machine, self._it.report))

    # -- inside

    def _advance(self) -> None:
        """Begin the next leg of the script."""
        self._feeder = None
        try:
            leg = next(self._script)
        except (StopIteration, NotFoundError):
            self._over = True
            return
        if leg is None:
            return
        it = self._it
        words = "".join(f" {name}{to:.9f}" for name, to in leg.to.items())
        made = it.readier.straight(f"G93 G1{words} F", 60.0 / leg.time, "<home>", at=it.position())
        self._feeder = Feeder(LivePlan.of(made.plan.trajectory, it.machine), it.machine,
                              origin=it.report.executed, ahead=it.ahead)  # fmt: skip
        self._leg, self._base = leg, it.report.commanded.copy()
        self._pending.append(Orders(watch=leg.watches))

    def _moved_from(self, segments: Segments) -> Segments:
        """Return the motion of the axes as that of the joints that move: from where they are told to be."""
        assert self._leg is not None, "something moves"
        it = self._it
        joints = segments.joints.copy()
        joints[:, :, 0] += self._base - it.machine.kinematics.matrix @ axes_of(it.machine, self._base)
        if self._leg.joint is not None:
            others = np.arange(joints.shape[1]) != self._leg.joint
            joints[:, others] = 0.0
            joints[:, others, 0] = self._base[others]
        return replace(segments, joints=joints)
