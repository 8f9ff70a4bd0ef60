"""The search for the axes' references.

In: the machine's own description of its switches.  Out: orders; positions are named where the switch was caught, and
trusted from then on.  One axis after another, in the order of the machine file:

    off the switch, if it is on it -> towards it, fast -> off it by ``back_off`` -> onto it, slowly -> name -> ``rest``

With an index the slow approach goes on to the encoder's next pulse, and that is named; with an index alone it is all.
The joints of a gantry go on one by one, each to its own switch, and then the second to where the first stands.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import Orders, Trouble, Watch
from trochia.backends.switches import index_of
from trochia.controller.feeder import Feeder
from trochia.controller.placement import FURTHER, SEARCH, placement
from trochia.controller.states import Event
from trochia.controller.status import axes_of
from trochia.errors import LocalProtocolError
from trochia.messages import Cause
from trochia.planner.live import LivePlan

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from trochia.backends.live import Report
    from trochia.backends.segments import Segments
    from trochia.controller.controller import Controller
    from trochia.machine.axes import Axis
    from trochia.machine.homing import Homing
    from trochia.machine.machine import Machine


class _NotFound(Exception):  # noqa: N818 - it is no error: it ends a script
    """A switch was not where it should be; the fault is raised already."""


APART = 1e-6  #: joints of a gantry that differ by more do not stand square [mm or degree]
LATCH = 0.1  #: of the speed of the search, where the file says nothing


@dataclass(frozen=True, slots=True)
class Move:
    """One straight move of one axis, or of a joint of it alone; ``watches`` is what it looks for."""

    axis: Axis
    to: float
    speed: float
    watches: tuple[Watch, ...] = ()
    joint: int | None = None


class Home:
    """Homing of some axes.

    Raises
    ------
    LocalProtocolError
        When an axis has no way home that this backend can go.
    """

    def __init__(self, it: Controller, axes: tuple[Axis, ...]) -> None:
        for axis in axes:
            index = _index(it.machine, axis)
            if index and index[0] not in it.report.inputs:
                raise LocalProtocolError(f"{axis.name} is homed to an encoder's index, which this backend cannot catch",
                                         hint="Home it to its switch: home.method in the machine file.")  # fmt: skip
            wrong = next(placement(axis, index[1] if index else 0.0), None)
            if wrong is not None:
                raise LocalProtocolError(f"{axis.name} cannot be homed safely: {wrong}",
                                         hint="Move the switch, or lower the speed of the search.")  # fmt: skip
        ordered = sorted(axes, key=lambda axis: axis.home.order if axis.home else 0)
        self._it = it
        self._script = self._all(ordered)
        self._move: Move | None = None
        self._base = it.report.commanded.copy()  # of the joints, where the move under way began
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
                yield Orders(segments=self._moved_from(segments), at=at)

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
        """Watch nothing any more; joints of a gantry that stand apart are called as if they did not."""
        return Orders(watch=(), place=squared(self._it.machine, self._it.report))

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
        made = it.readier.ready(feed, "<home>", work=it.work.__class__(), at=it.position(), bounded=False,
                                ours=True)  # fmt: skip
        self._feeder = Feeder(LivePlan.of(made.plan.trajectory, it.machine), it.machine,
                              origin=it.report.executed, ahead=it.ahead)  # fmt: skip
        self._move, self._base = move, it.report.commanded.copy()
        self._pending.append(Orders(watch=move.watches))

    def _moved_from(self, segments: Segments) -> Segments:
        """Return the motion of the axis as that of the joints that move: from where they are told to be."""
        assert self._move is not None, "something moves"
        it = self._it
        joints = segments.joints.copy()
        joints[:, :, 0] += self._base - it.machine.kinematics.matrix @ axes_of(it.machine, self._base)
        if self._move.joint is not None:
            others = np.arange(joints.shape[1]) != self._move.joint
            joints[:, others] = 0.0
            joints[:, others, 0] = self._base[others]
        return replace(segments, joints=joints)

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
        it.trusted[axis.name] = False
        search = home.search or SEARCH * axis.velocity
        if home.method != "index":
            yield from self._to_switch(axis, home, search)
        index = _index(it.machine, axis)
        if index is not None:
            name, turn = index
            to = self._here(axis) + _sign(home) * FURTHER * turn
            yield Move(axis, to, home.latch or LATCH * search, (Watch(name=name, level=True),))
            self._check(f"no index pulse came in {FURTHER * turn:g} {axis.unit}", axis)
        if home.second is None:
            self._name(axis, home)
            yield None  # until the backend has taken the name
        else:
            yield from self._square(axis, home, search)
        it.trusted[axis.name] = True
        it.note("homed", axis=axis.name, position=_at(axis, home))
        if home.rest is not None:
            yield Move(axis, home.rest, search)

    def _to_switch(self, axis: Axis, home: Homing, search: float) -> Generator[Move | None]:
        """Yield the moves up to the edge of the switch, slowly the second time; of a gantry whichever comes first."""
        sign, latch = _sign(home), home.latch or LATCH * search
        reach = FURTHER * (axis.maximum - axis.minimum)
        names = switches_of(axis, home)
        told = " or ".join(names)
        for name in names:
            if self._it.report.inputs.get(name):
                yield Move(axis, self._here(axis) - sign * reach, latch, (Watch(name=name, level=False),))
                self._check(f"{name} stays active while the axis drives away from it", axis)
        found = tuple(Watch(name=name, level=True) for name in names)
        yield Move(axis, self._here(axis) + sign * reach, search, found)
        self._check(f"the switch {told} was not found in {reach:g} {axis.unit}", axis)
        yield Move(axis, self._here(axis) - sign * home.back_off, search)
        for name in names:
            if self._it.report.inputs.get(name):
                yield Move(axis, self._here(axis) - sign * reach, latch, (Watch(name=name, level=False),))
        yield Move(axis, self._here(axis) + sign * 2.0 * home.back_off, latch, found)
        self._check(f"the switch {told} was lost on the second approach", axis)

    def _square(self, axis: Axis, home: Homing, search: float) -> Generator[Move | None]:
        """Yield the moves that take the other joint of a gantry to its switch, and then beside the first."""
        it, latch = self._it, home.latch or LATCH * search
        matrix = it.machine.kinematics.matrix
        pair = [int(i) for i in np.flatnonzero(matrix[:, [a.name for a in it.machine.axes].index(axis.name)])]
        names = switches_of(axis, home)
        caught = it.report.caught
        assert caught is not None, "a switch was caught"
        edges = {caught[0]: caught[1]}
        for name, joint in zip(names, pair, strict=True):
            if name not in edges:
                to = self._here(axis) + _sign(home) * 2.0 * home.back_off
                yield Move(axis, to, latch, (Watch(name=name, level=True),), joint)
                self._check(f"the switch {name} was not found in {2.0 * home.back_off:g} {axis.unit}, with the other "
                            "joint of the gantry at its own", axis)  # fmt: skip
                assert it.report.caught is not None, "a switch was caught"
                edges[name] = it.report.caught[1]
        column = [a.name for a in it.machine.axes].index(axis.name)
        place: dict[str, float] = {}
        for name, joint, shift in zip(names, pair, (0.0, home.square), strict=True):
            way = it.report.commanded[joint] - edges[name][joint]
            place[it.machine.joints[joint].name] = float((_at(axis, home) + shift) * matrix[joint, column] + way)
        self._pending.append(Orders(watch=(), place=place))
        yield None
        first, second = (float(it.report.commanded[joint] / matrix[joint, column]) for joint in pair)
        yield Move(axis, self._here(axis) + first - second, latch, (), pair[1])

    def _here(self, axis: Axis) -> float:
        return self._it.position()[axis.name]

    def _check(self, why: str, axis: Axis) -> None:
        if self._it.report.caught is None:
            self._it.fault(Trouble(cause=Cause.HOMING, joint=axis.name), why)
            self._it.pending.append(self.finish(whole=False))
            raise _NotFound

    def _name(self, axis: Axis, home: Homing) -> None:
        """Call the caught place by the reference's position."""
        it = self._it
        assert it.report.caught is not None, "the switch was caught"
        at = _at(axis, home)
        column = [a.name for a in it.machine.axes].index(axis.name)
        shift = np.zeros(len(it.machine.axes))
        shift[column] = at - axes_of(it.machine, it.report.caught[1])[column]
        joints = it.report.commanded + it.machine.kinematics.matrix @ shift
        moved = np.abs(it.machine.kinematics.matrix[:, column]) > 0.0
        place = {joint.name: float(value)
                 for joint, value, own in zip(it.machine.joints, joints, moved, strict=True) if own}  # fmt: skip
        self._pending.append(Orders(watch=(), place=place))


def squared(machine: Machine, report: Report) -> dict[str, float]:
    """Return what joints that stand apart on their axis would be called if they did not, {joint: mm or degree}."""
    square = machine.kinematics.matrix @ axes_of(machine, report.commanded)
    apart = np.abs(square - report.commanded) > APART
    return {joint.name: float(at) for joint, at, is_so in zip(machine.joints, square, apart, strict=True) if is_so}


def switches_of(axis: Axis, home: Homing) -> tuple[str, ...]:
    """Return the names of the inputs that an axis is homed to: two where it is a gantry."""
    if home.method == "limit":
        switch = axis.limit_plus if home.towards == "+" else axis.limit_minus
        assert switch is not None, "the machine file was checked"
        return (switch.input,)
    assert home.input is not None, "the machine file was checked"
    return (home.input,) if home.second is None else (home.input, home.second)


def _sign(home: Homing) -> float:
    return 1.0 if home.towards == "+" else -1.0


def _at(axis: Axis, home: Homing) -> float:
    """Return what an axis reads at its reference."""
    if home.position is not None:
        return home.position
    return axis.maximum if home.towards == "+" else axis.minimum


def _index(machine: Machine, axis: Axis) -> tuple[str, float] | None:
    """Return the index pulse an axis is homed to, as an input, and its way a turn of the motor; None: to none."""
    if axis.home is None or not axis.home.method.endswith("index"):
        return None
    column = machine.kinematics.matrix[:, [a.name for a in machine.axes].index(axis.name)]
    for joint, part in zip(machine.joints, column, strict=True):
        if part and joint.encoder is not None and joint.encoder.index:
            return index_of(joint.name), float(joint.transmission.travel_per_turn) / abs(float(part))
    return None
