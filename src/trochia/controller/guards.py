"""What the controller watches for by itself at every report: limit switches, and axes that run faster than they may.

In: reports.  Out: troubles.  A limit switch is a fault when its axis moves onto it, not when it stands on it: it can
be driven away by hand.  A switch that an axis is being homed to is none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from trochia.backends.live import Trouble
from trochia.controller.status import axes_of
from trochia.machine.rates import joint_velocity
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.backends.live import Report
    from trochia.machine.axes import Axis
    from trochia.machine.machine import Machine

SPAN = 0.02  #: time over which an encoder's speed is taken [s]
OVER = 1.2  #: times its greatest speed is too fast for a joint, beside a count
_STILL = 1e-9  #: mm/s or degree/s


class End(NamedTuple):
    """A limit switch: its axis' number, its side, its input, where it trips [mm or degree]."""

    axis: int
    side: float
    input: str
    at: float


def ends_of(machine: Machine) -> tuple[End, ...]:
    """Return the limit switches of a machine."""
    found: list[End] = []
    for i, axis in enumerate(machine.axes):
        for side, switch in ((-1.0, axis.limit_minus), (1.0, axis.limit_plus)):
            if switch is not None:
                found.append(End(i, side, switch.input, switch.at))
    return tuple(found)


def stands_on(machine: Machine, report: Report, axis: str, direction: float) -> str | None:
    """Return the limit switch an axis stands on in the direction it is to move, or None."""
    for end in ends_of(machine):
        if machine.axes[end.axis].name == axis and end.side * direction > 0.0 and report.inputs.get(end.input):
            return end.input
    return None


class Guards:
    """The watch over one machine."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._ends = ends_of(machine)
        self._most = np.array([OVER * joint_velocity(machine, i) for i in range(len(machine.joints))])
        self._before: tuple[float, NDArray[np.float64]] | None = None

    def troubles(self, report: Report, *, homing: bool) -> Iterator[Trouble]:
        """Yield what is wrong now; ``homing``: switches that axes are homed to are none, and positions are renamed."""
        velocity = axes_of(self._machine, report.velocity) if self._ends else None
        for end in self._ends if velocity is not None else ():
            axis = self._machine.axes[end.axis]
            if homing and homes_to(axis, end.input):
                continue
            if report.inputs.get(end.input) and velocity is not None and velocity[end.axis] * end.side > _STILL:
                place = float(axes_of(self._machine, report.commanded)[end.axis])
                yield Trouble(cause=Cause.HARD_LIMIT, joint=axis.name, value=place, limit=end.at)
        yield from self._too_fast(report, homing=homing)

    def _too_fast(self, report: Report, *, homing: bool) -> Iterator[Trouble]:
        """Yield joints whose encoders run too fast."""
        if homing or report.encoder is None or not report.enabled:
            self._before = None
            return
        if self._before is None:
            self._before = (report.time, report.encoder)
            return
        span = report.time - self._before[0]
        if span < SPAN:
            return
        speed = np.abs(report.encoder - self._before[1]) / span
        self._before = (report.time, report.encoder)
        for joint, v, most in zip(self._machine.joints, speed, self._most, strict=True):
            count = 2.0 / float(joint.counts_per_unit or np.inf)
            if v * span > most * span + count:
                yield Trouble(cause=Cause.OVER_SPEED, joint=joint.name, value=float(v), limit=float(most))


def homes_to(axis: Axis, name: str) -> bool:
    """Whether an axis is homed to an input."""
    home = axis.home
    if home is None:
        return False
    if home.method == "limit":
        switch = axis.limit_plus if home.towards == "+" else axis.limit_minus
        return switch is not None and switch.input == name
    return name in {home.input, home.second}
