"""The search for the axes' references, as a script of straight legs.

In: the machine's own description of its switches.  Out: legs, between which everything rests.  Axes of one order go
together, lower orders first:

    off their switches, if they are on them -> towards them, fast -> off them by ``back_off`` -> onto them, slowly
    -> name -> ``rest``

Each axis goes at its own speed.  A switch that is found stops all of them along their way, and those that have not
found theirs go on from there.  An edge counts when the backend caught it; an axis that ran onto its switch while it
braked for another's goes back and comes again.  Axes that share a switch, or would brake too far together, go by turns.

With an index the slow approach goes on to the encoder's next pulse, one axis at a time: nothing else stops it, so no
pulse is passed unseen.  The joints of a gantry go on one by one, each to its own switch, and then the second to where
the first stands.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from trochia.backends.live import Orders, Trouble, Watch
from trochia.backends.switches import index_of
from trochia.controller.placement import FURTHER, SEARCH, braking_distance
from trochia.controller.status import axes_of
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Mapping

    from numpy.typing import NDArray

    from trochia.backends.live import Report
    from trochia.controller.controller import Controller
    from trochia.machine.axes import Axis
    from trochia.machine.homing import Homing
    from trochia.machine.machine import Machine


class NotFoundError(Exception):
    """A switch was not where it should be; the fault is raised already."""


APART = 1e-6  #: joints of a gantry that differ by more do not stand square [mm or degree]
LATCH = 0.1  #: of the speed of the search, where the file says nothing
TWICE = 2.0  #: times its own way to brake an axis may take when it brakes with others
_LEAST = 1e-3  #: time a leg is given at least [s]


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight way of some axes to places [mm or degree] in a time [s], or of one joint alone; what it looks for."""

    to: Mapping[str, float]
    time: float
    watches: tuple[Watch, ...] = ()
    joint: int | None = None


@dataclass(frozen=True, slots=True)
class _Seek:
    """How one axis looks for its switch: signed speed [mm/s or degree/s], how far [mm or degree], what it misses."""

    velocity: float
    reach: float
    why: str


class Search:
    """The script of one homing; ``tell`` takes orders that are no motion."""

    def __init__(self, it: Controller, tell: Callable[[Orders], None]) -> None:
        self._it, self._tell = it, tell
        self._edges: dict[str, tuple[str, NDArray[np.float64]]] = {}  # what was caught last, by axis

    def all(self, axes: Iterable[Axis]) -> Generator[Leg | None]:
        """Yield every leg in order; None: nothing moves for a turn.

        Raises
        ------
        NotFoundError
            When a switch or an index did not come; the fault is raised.
        """
        for together in rounds(axes):
            yield from self._round(together)

    # -- some axes together

    def _round(self, axes: list[Axis]) -> Generator[Leg | None]:
        it = self._it
        for axis in axes:
            if axis.home is None or axis.home.method == "absolute":
                self._found(axis, self._here(axis))
            else:
                it.trusted[axis.name] = False
        homed = [(axis, axis.home) for axis in axes if axis.home is not None and axis.home.method != "absolute"]
        yield from self._to_switches({axis: home for axis, home in homed if home.method != "index"})
        for axis, home in homed:
            yield from self._to_index(axis, home)
        single = {axis: home for axis, home in homed if home.second is None}
        if single:
            self._name(single)
            yield None  # until the backend has taken the names
        for axis, home in homed:
            if home.second is not None:
                yield from self._square(axis, home)
            self._found(axis, _at(axis, home))
        rests = {axis: home.rest for axis, home in homed if home.rest is not None}
        if rests:
            yield self._straight({axis: (to, _search(axis, axis.home)) for axis, to in rests.items()})

    def _found(self, axis: Axis, position: float) -> None:
        self._it.trusted[axis.name] = True
        self._it.note("homed", axis=axis.name, position=position)

    def _to_switches(self, homes: dict[Axis, Homing]) -> Generator[Leg | None]:
        """Yield the legs up to the edges of the switches, slowly the second time; of a gantry whichever comes first."""
        reach = {axis: FURTHER * (axis.maximum - axis.minimum) for axis in homes}
        told = {axis: " or ".join(switches_of(axis, home)) for axis, home in homes.items()}
        yield from self._clear(homes)
        yield from self._seek({
            axis: _Seek(_sign(home) * _search(axis, home), reach[axis],
                        f"the switch {told[axis]} was not found in {reach[axis]:g} {axis.unit}")
            for axis, home in homes.items()
        }, level=True)  # fmt: skip
        left = dict(homes)
        while left:
            yield self._straight({axis: (self._here(axis) - _sign(home) * home.back_off, _search(axis, home))
                                  for axis, home in left.items()})  # fmt: skip
            yield from self._clear(left)
            caught = yield from self._seek({
                axis: _Seek(_sign(home) * _latch(axis, home), 2.0 * home.back_off,
                            f"the switch {told[axis]} was lost on the second approach")
                for axis, home in left.items()
            }, level=True)  # fmt: skip
            left = {axis: home for axis, home in left.items() if axis not in caught}

    def _clear(self, homes: dict[Axis, Homing]) -> Generator[Leg | None]:
        """Yield the legs that drive axes off switches on which they stand."""
        yield from self._seek({
            axis: _Seek(-_sign(home) * _latch(axis, home), FURTHER * (axis.maximum - axis.minimum),
                        f"{' and '.join(self._active(axis, home))} stays active while the axis drives away from it")
            for axis, home in homes.items() if self._active(axis, home)
        }, level=False)  # fmt: skip

    def _active(self, axis: Axis, home: Homing) -> list[str]:
        return [name for name in switches_of(axis, home) if self._it.report.inputs.get(name)]

    def _seek(self, seeks: dict[Axis, _Seek], *, level: bool) -> Generator[Leg | None, None, set[Axis]]:
        """Yield legs until every axis' switch has a level; return the axes whose edge was caught by the backend."""
        caught: set[Axis] = set()
        left = {axis: seek.reach for axis, seek in seeks.items()}
        while missing := [axis for axis in seeks if axis not in caught and not self._has(axis, level=level)]:
            begin = {axis: self._here(axis) for axis in missing}
            time = max(_LEAST, min(left[axis] / abs(seeks[axis].velocity) for axis in missing))
            watches = {name: axis for axis in missing for name in self._watched(axis, level=level)}
            yield Leg({axis.name: begin[axis] + time * seeks[axis].velocity for axis in missing}, time,
                      tuple(Watch(name=name, level=level) for name in watches))  # fmt: skip
            for axis in missing:
                left[axis] -= abs(self._here(axis) - begin[axis])
            if self._it.report.caught is None:
                last = min(missing, key=lambda axis: left[axis])
                self._missed(seeks[last].why, last)
            else:
                axis = watches[self._it.report.caught[0]]
                self._edges[axis.name] = self._it.report.caught
                if level or self._has(axis, level=False):
                    caught.add(axis)
        return caught

    def _has(self, axis: Axis, *, level: bool) -> bool:
        """Whether an axis stands on a switch of its own, or on none."""
        assert axis.home is not None, "it is homed"
        return bool(self._active(axis, axis.home)) == level

    def _watched(self, axis: Axis, *, level: bool) -> list[str]:
        """Return the switches of an axis that have not got a level."""
        assert axis.home is not None, "it is homed"
        return [name for name in switches_of(axis, axis.home) if bool(self._it.report.inputs.get(name)) != level]

    def _straight(self, ways: Mapping[Axis, tuple[float, float]]) -> Leg:
        """Return the leg of some axes to places at speeds; the slowest gives the time."""
        time = max(abs(to - self._here(axis)) / speed for axis, (to, speed) in ways.items())
        return Leg({axis.name: to for axis, (to, _) in ways.items()}, max(time, _LEAST))

    # -- one axis

    def _to_index(self, axis: Axis, home: Homing) -> Generator[Leg | None]:
        index = index_pulse(self._it.machine, axis)
        if index is None:
            return
        name, turn = index
        way = FURTHER * turn
        yield Leg({axis.name: self._here(axis) + _sign(home) * way}, way / _latch(axis, home),
                  (Watch(name=name, level=True),))  # fmt: skip
        if self._it.report.caught is None:
            self._missed(f"no index pulse came in {way:g} {axis.unit}", axis)
        else:
            self._edges[axis.name] = self._it.report.caught

    def _square(self, axis: Axis, home: Homing) -> Generator[Leg | None]:
        """Yield the legs that take the other joint of a gantry to its switch, and then beside the first."""
        it, latch = self._it, _latch(axis, home)
        matrix = it.machine.kinematics.matrix
        column = _column(it.machine, axis)
        pair = [int(i) for i in np.flatnonzero(matrix[:, column])]
        names = switches_of(axis, home)
        first_name, first_edge = self._edges[axis.name]
        edges = {first_name: first_edge}
        for name, joint in zip(names, pair, strict=True):
            if name not in edges:
                way = 2.0 * home.back_off
                yield Leg({axis.name: self._here(axis) + _sign(home) * way}, way / latch,
                          (Watch(name=name, level=True),), joint)  # fmt: skip
                if it.report.caught is None:
                    self._missed(f"the switch {name} was not found in {way:g} {axis.unit}, with the other "
                                 "joint of the gantry at its own", axis)  # fmt: skip
                else:
                    edges[name] = it.report.caught[1]
        place: dict[str, float] = {}
        for name, joint, shift in zip(names, pair, (0.0, home.square), strict=True):
            beyond = it.report.commanded[joint] - edges[name][joint]
            place[it.machine.joints[joint].name] = float((_at(axis, home) + shift) * matrix[joint, column] + beyond)
        self._tell(Orders(watch=(), place=place))
        yield None
        first, second = (float(it.report.commanded[joint] / matrix[joint, column]) for joint in pair)
        way = first - second
        yield Leg({axis.name: self._here(axis) + way}, max(abs(way) / latch, _LEAST), (), pair[1])

    def _name(self, homes: Mapping[Axis, Homing]) -> None:
        """Call the caught places by the references' positions."""
        it = self._it
        matrix = it.machine.kinematics.matrix
        shift = np.zeros(len(it.machine.axes))
        for axis, home in homes.items():
            column = _column(it.machine, axis)
            shift[column] = _at(axis, home) - axes_of(it.machine, self._edges[axis.name][1])[column]
        joints = it.report.commanded + matrix @ shift
        moved: NDArray[np.bool_] = np.any(matrix[:, [_column(it.machine, axis) for axis in homes]] != 0.0, axis=1)
        place = {joint.name: float(value)
                 for joint, value, own in zip(it.machine.joints, joints, moved, strict=True) if own}  # fmt: skip
        self._tell(Orders(watch=(), place=place))

    def _here(self, axis: Axis) -> float:
        return self._it.position()[axis.name]

    def _missed(self, why: str, axis: Axis) -> None:
        it = self._it
        it.fault(Trouble(cause=Cause.HOMING, joint=axis.name), why)
        it.pending.append(Orders(watch=(), place=squared(it.machine, it.report)))
        raise NotFoundError


def rounds(axes: Iterable[Axis]) -> list[list[Axis]]:
    """Return the axes that go home together, round by round: those of one order that may."""

    def order(axis: Axis) -> int:
        told = None if axis.home is None else axis.home.order
        return int(axis.name != "Z") if told is None else told

    made: list[list[Axis]] = []
    for _, equal in groupby(sorted(axes, key=order), key=order):
        own: list[list[Axis]] = []
        for axis in equal:
            fits = next((some for some in own if _together([*some, axis])), None)
            if fits is None:
                own.append([axis])
            else:
                fits.append(axis)
        made += own
    return made


def _together(axes: list[Axis]) -> bool:
    """Whether axes share no switch, and none brakes much further, or onto its limit, because another takes longer."""
    moving = [(axis, axis.home) for axis in axes if axis.home is not None and axis.home.method != "absolute"]
    names = [name for axis, home in moving if home.method != "index" for name in switches_of(axis, home)]
    ways = [(braking_distance(axis, _search(axis, home)), _search(axis, home)) for axis, home in moving]
    time = max((2.0 * way / speed for way, speed in ways), default=0.0)
    return len(set(names)) == len(names) and all(
        0.5 * time * speed <= min(TWICE * way, _room(axis, home))
        for (axis, home), (way, speed) in zip(moving, ways, strict=True)
    )


def _room(axis: Axis, home: Homing) -> float:
    """Return the way from an axis' home switch to the limit switch behind it [mm or degree]; inf: there is none."""
    behind = axis.limit_plus if home.towards == "+" else axis.limit_minus
    if behind is None or home.method == "limit" or home.input is None:
        return np.inf
    return _sign(home) * (behind.at - _at(axis, home))


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


def index_pulse(machine: Machine, axis: Axis) -> tuple[str, float] | None:
    """Return the index pulse an axis is homed to, as an input, and its way a turn of the motor; None: to none."""
    if axis.home is None or not axis.home.method.endswith("index"):
        return None
    column = machine.kinematics.matrix[:, _column(machine, axis)]
    for joint, part in zip(machine.joints, column, strict=True):
        if part and joint.encoder is not None and joint.encoder.index:
            return index_of(joint.name), float(joint.transmission.travel_per_turn) / abs(float(part))
    return None


def _column(machine: Machine, axis: Axis) -> int:
    return [a.name for a in machine.axes].index(axis.name)


def _search(axis: Axis, home: Homing | None) -> float:
    """Return the speed of the search [mm/s or degree/s]."""
    return (home.search if home is not None else None) or SEARCH * axis.velocity


def _latch(axis: Axis, home: Homing) -> float:
    """Return the speed of the second approach [mm/s or degree/s]."""
    return home.latch or LATCH * _search(axis, home)


def _sign(home: Homing) -> float:
    return 1.0 if home.towards == "+" else -1.0


def _at(axis: Axis, home: Homing) -> float:
    """Return what an axis reads at its reference."""
    if home.position is not None:
        return home.position
    return axis.maximum if home.towards == "+" else axis.minimum
