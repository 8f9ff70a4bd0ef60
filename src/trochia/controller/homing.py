"""The search for the axes' references.

In: the machine's own description of its switches.  Out: orders; positions are named where the switch was caught, and
trusted from then on.  One axis after another, in the order of the machine file:

    off the switch, if it is on it -> towards it, fast -> off it by ``back_off`` -> onto it, slowly -> name -> ``rest``
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import Orders, Trouble, Watch
from trochia.controller.feeder import Feeder
from trochia.controller.placement import SEARCH, placement
from trochia.controller.states import Event
from trochia.controller.status import axes_of
from trochia.errors import LocalProtocolError
from trochia.messages import Cause
from trochia.planner.live import LivePlan

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from trochia.backends.live import Report
    from trochia.controller.controller import Controller
    from trochia.machine.axes import Axis
    from trochia.machine.homing import Homing


class _NotFound(Exception):  # noqa: N818 - it is no error: it ends a script
    """A switch was not where it should be; the fault is raised already."""


FURTHER = 1.1  #: of the travel is searched
LATCH = 0.1  #: of the speed of the search, where the file says nothing


class Move:
    """One straight move of one axis; ``watch`` is the switch it looks for."""

    def __init__(self, axis: Axis, to: float, speed: float, watch: Watch | None = None) -> None:
        self.axis, self.to, self.speed, self.watch = axis, to, speed, watch


class Home:
    """Homing of some axes.

    Raises
    ------
    LocalProtocolError
        When an axis has no way home that this backend can go.
    """

    def __init__(self, it: Controller, axes: tuple[Axis, ...]) -> None:
        for axis in axes:
            if axis.home is not None and axis.home.method.endswith("index"):
                raise LocalProtocolError(
                    f"{axis.name} is homed to its encoder's index, which this backend cannot catch"
                )
            wrong = next(placement(axis), None)
            if wrong is not None:
                raise LocalProtocolError(f"{axis.name} cannot be homed safely: {wrong}",
                                         hint="Move the switch, or lower the speed of the search.")  # fmt: skip
        ordered = sorted(axes, key=lambda axis: axis.home.order if axis.home else 0)
        self._it = it
        self._script = self._all(ordered)
        self._move: Move | None = None
        self._feeder: Feeder | None = None
        self._pending: list[Orders] = []
        self._over = self._braking = False
        self._advance()

    # -- as an activity

    def feed(self, report: Report) -> Iterator[Orders]:
        """Yield the next orders; none once the switch was caught."""
        orders, self._pending = self._pending, []
        yield from orders
        if self._feeder is not None and report.caught is None:
            for segments, at, _ in self._feeder.more(report.executed, lambda _: None):
                yield Orders(segments=segments, at=at)

    def event(self, report: Report) -> Event | None:
        """Return STILL when all is done; between moves go on with the next."""
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
        """Watch nothing any more."""
        return Orders(watch=())

    # -- inside

    def _advance(self) -> None:
        """Begin the next move of the script."""
        self._feeder = None
        try:
            move = next(self._script)
        except (StopIteration, _NotFound):
            self._over = True
            return
        if move is None:
            return
        it = self._it
        feed = f"G21 G90 G94 G53 G1 {move.axis.name}{move.to:.9f} F{60.0 * move.speed:.9f}\nM2\n"
        made = it.readier.ready(feed, "<home>", work=it.work.__class__(), at=it.position(), bounded=False)
        self._feeder = Feeder(LivePlan.of(made.plan.trajectory, it.machine), it.machine,
                              origin=it.report.executed, ahead=it.ahead)  # fmt: skip
        self._pending.append(Orders(watch=() if move.watch is None else (move.watch,)))

    def _all(self, axes: list[Axis]) -> Generator[Move | None]:
        for axis in axes:
            yield from self._one(axis)

    def _one(self, axis: Axis) -> Generator[Move | None]:
        """Yield the moves that home an axis; what is between them happens at rest.  None: nothing moves for a turn."""
        it, home = self._it, axis.home
        if home is None or home.method == "absolute":
            it.trusted[axis.name] = True
            it.note("homed", axis=axis.name, position=self._here(axis))
            return
        sign = 1.0 if home.towards == "+" else -1.0
        name = switch_of(axis, home)
        search = home.search or SEARCH * axis.velocity
        latch = home.latch or LATCH * search
        reach = FURTHER * (axis.maximum - axis.minimum)
        it.trusted[axis.name] = False
        if it.report.inputs.get(name):
            yield Move(axis, self._here(axis) - sign * reach, latch, Watch(name=name, level=False))
            self._check("it stays active while the axis drives away from it", axis)
        yield Move(axis, self._here(axis) + sign * reach, search, Watch(name=name, level=True))
        self._check(f"the switch {name} was not found in {reach:g} {axis.unit}", axis)
        yield Move(axis, self._here(axis) - sign * home.back_off, search)
        if it.report.inputs.get(name):
            yield Move(axis, self._here(axis) - sign * reach, latch, Watch(name=name, level=False))
        yield Move(axis, self._here(axis) + sign * 2.0 * home.back_off, latch, Watch(name=name, level=True))
        self._check(f"the switch {name} was lost on the second approach", axis)
        self._name(axis, home)
        yield None  # until the backend has taken the name
        if home.rest is not None:
            yield Move(axis, home.rest, search)

    def _here(self, axis: Axis) -> float:
        return self._it.position()[axis.name]

    def _check(self, why: str, axis: Axis) -> None:
        if self._it.report.caught is None:
            self._it.fault(Trouble(cause=Cause.HOMING, joint=axis.name), why)
            raise _NotFound

    def _name(self, axis: Axis, home: Homing) -> None:
        """Call the caught place by the reference's position."""
        it = self._it
        assert it.report.caught is not None, "the switch was caught"
        at = home.position
        if at is None:
            at = axis.maximum if home.towards == "+" else axis.minimum
        column = [a.name for a in it.machine.axes].index(axis.name)
        shift = np.zeros(len(it.machine.axes))
        shift[column] = at - axes_of(it.machine, it.report.caught[1])[column]
        joints = it.report.commanded + it.machine.kinematics.matrix @ shift
        moved = np.abs(it.machine.kinematics.matrix[:, column]) > 0.0
        place = {joint.name: float(value)
                 for joint, value, own in zip(it.machine.joints, joints, moved, strict=True) if own}  # fmt: skip
        self._pending.append(Orders(watch=(), place=place))
        it.trusted[axis.name] = True
        it.note("homed", axis=axis.name, position=at)


def switch_of(axis: Axis, home: Homing) -> str:
    """Return the name of the input that an axis is homed to."""
    if home.method == "limit":
        switch = axis.limit_plus if home.towards == "+" else axis.limit_minus
        assert switch is not None, "the machine file was checked"
        return switch.input
    assert home.input is not None, "the machine file was checked"
    return home.input
