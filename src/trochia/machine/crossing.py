"""Where what axes are asked becomes what motors are told: squareness, screw errors and backlash are corrected here.

In: joints as the kinematics give them, over time.  Out: joints as their motors are told, and back.  This is the one
place: the twin, live backends and step timing all cross here.

Legend: p a joint as asked, q the same with squareness corrected (q = L p), e its error table, m what its motor is told:

    m = q - e(q) + o(t),    m' = (1 - e') q' + o',    m'' = (1 - e') q'' - e'' q'² + o''

with o what makes up the backlash b: half of it one way, half the other, and from one to the other after each reversal
by b S(t / T), S(s) = 10 s³ - 15 s⁴ + 6 s⁵.  e is the measured error at the place the motor was told; q - e(q) leaves
an error of e e', nanometres.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from trochia.machine.reserve import take_up_time

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from trochia.machine.compensation import Squareness
    from trochia.machine.error_table import ErrorTable
    from trochia.machine.machine import Machine

STILL = 1e-9  #: of a velocity that turns nothing round [mm/s or degree/s]
_ROUNDS = 4  #: of inverting the table; each gains two digits or more


@dataclass(frozen=True, slots=True, eq=False)
class Crossing:
    """The corrections of one machine that do not ask what was before.

    Attributes
    ----------
    mix
        L (joints, joints).
    tables
        Error tables by joint.
    backlash, time
        Of each joint: what is made up (joints,) [mm or degree], and in how long (joints,) [s].
    """

    mix: NDArray[np.float64]
    tables: dict[int, ErrorTable]
    backlash: NDArray[np.float64]
    time: NDArray[np.float64]

    def motor(self, p: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return q - e(q) of joints (n, joints)."""
        q = p @ self.mix.T
        for j, table in self.tables.items():
            q[:, j] -= table.at(q[:, j])
        return q

    def rate(self, p: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (1 - e') q' at places and velocities of joints (n, joints)."""
        q, rate = p @ self.mix.T, v @ self.mix.T
        for j, table in self.tables.items():
            rate[:, j] *= 1.0 - table.slope(q[:, j])
        return rate

    def asked(self, m: NDArray[np.float64], *, loads: NDArray[np.bool_] | None = None) -> NDArray[np.float64]:
        """Return joints as asked (n, joints) of what motors have come to without backlash.

        ``loads`` says which of them (joints,) are places of the load, not of the motor.
        """
        q = m.copy()
        for j, table in self.tables.items():
            if loads is None or not loads[j]:
                for _ in range(_ROUNDS):
                    q[:, j] = m[:, j] + table.at(q[:, j])
        return np.asarray(np.linalg.solve(self.mix, q.T).T, np.float64)

    def take_up(self) -> TakeUp:
        """Return what makes up the backlash, before anything has moved."""
        return TakeUp(self.backlash, self.time)


@dataclass(slots=True)
class TakeUp:
    """Makes up backlash: remembers which way each joint has turned, and when.

    Times may be taken back (:meth:`cut`), so that motion that is planned anew takes its reversals with it.
    """

    backlash: NDArray[np.float64]
    time: NDArray[np.float64]
    _turns: list[list[tuple[float, int]]] = field(init=False)  # of each joint: (when, which way from then on)
    _ways: list[int] = field(init=False)  # which way before those

    def __post_init__(self) -> None:
        self._turns = [[] for _ in self.backlash]
        self._ways = [0] * len(self.backlash)

    def cut(self, at: float) -> None:
        """Forget what was to turn after a time."""
        for turns in self._turns:
            while turns and turns[-1][0] > at:
                turns.pop()

    def see(self, times: NDArray[np.float64], v: NDArray[np.float64]) -> None:
        """Take in velocities (n, joints) at rising times (n,), at least two, behind all that were seen."""
        for j in np.flatnonzero(self.backlash > 0.0):
            way = self._turns[j][-1][1] if self._turns[j] else self._ways[j]
            signs = np.where(np.abs(v[:, j]) > STILL, np.sign(v[:, j]), 0.0)
            for k in np.flatnonzero(signs):
                if signs[k] != way:
                    way = int(signs[k])
                    self._turns[j].append((self._when(times, v[:, j], int(k)), way))

    @staticmethod
    def _when(times: NDArray[np.float64], v: NDArray[np.float64], k: int) -> float:
        """Return when a velocity that has another sign at k was zero."""
        if k == 0:
            return float(times[0])
        before = v[k - 1] if abs(v[k - 1]) > STILL else 0.0
        return float(times[k - 1] + (times[k] - times[k - 1]) * before / (before - v[k]))

    def offset(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return o (n, joints)."""
        out = np.zeros((len(times), len(self.backlash)))
        for j, half in enumerate(0.5 * self.backlash):
            out[:, j] = half * self._ways[j]
            for when, change in self._changes(j):
                s = np.clip((times - when) / self.time[j], 0.0, 1.0)
                out[:, j] += change * half * s**3 * (10.0 + s * (6.0 * s - 15.0))
        return out

    def rate(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return o' (n, joints)."""
        out = np.zeros((len(times), len(self.backlash)))
        for j, half in enumerate(0.5 * self.backlash):
            for when, change in self._changes(j):
                s = np.clip((times - when) / self.time[j], 0.0, 1.0)
                out[:, j] += change * half * 30.0 * (s * (1.0 - s)) ** 2 / self.time[j]
        return out

    def left(self, at: float) -> float:
        """Return how long after a time something is still being made up [s]."""
        ends = [turns[-1][0] + self.time[j] for j, turns in enumerate(self._turns) if turns]
        return max(max(ends, default=at) - at, 0.0)

    def forget(self, before: float) -> None:
        """Drop the turns that are made up at a time."""
        for j, turns in enumerate(self._turns):
            while turns and turns[0][0] + self.time[j] < before:
                self._ways[j] = turns.pop(0)[1]

    def _changes(self, joint: int) -> Iterator[tuple[float, int]]:
        """Yield when a joint turned, and by how much its way changed (1 or 2, signed)."""
        way = self._ways[joint]
        for when, after in self._turns[joint]:
            yield when, after - way
            way = after


@lru_cache(maxsize=16)
def crossing_of(machine: Machine) -> Crossing | None:
    """Return the corrections of a machine; None where it has none."""
    given = [joint.compensation for joint in machine.joints]
    mix = leaning(machine, machine.squareness, correct=True)
    tables = {j: each.screw for j, each in enumerate(given) if each is not None and each.screw is not None}
    backlash = np.array([0.0 if each is None else each.backlash for each in given])
    if mix is None and not tables and not backlash.any():
        return None
    time = np.array([take_up_time(machine, j) if backlash[j] else 1.0 for j in range(len(given))])
    return Crossing(np.eye(len(given)) if mix is None else mix, tables, backlash, time)


def leaning(machine: Machine, skew: Squareness | None, *, correct: bool) -> NDArray[np.float64] | None:
    """Return how joints change by axes that are not square (joints, joints): the error, or its correction.

    None: they are square.
    """
    names = [axis.name for axis in machine.axes]
    leans = [] if skew is None else [lean for lean in skew.leans() if lean[0] in names and lean[1] in names]
    if not leans:
        return None
    axes = np.eye(len(names))
    for first, second, tangent in leans:
        axes[names.index(first), names.index(second)] = tangent if correct else -tangent
    matrix = machine.kinematics.matrix
    inverse = np.asarray(np.linalg.pinv(matrix), np.float64)
    # joints that no axes give (a gantry's two apart) stay as they are
    return np.asarray(matrix @ axes @ inverse + np.eye(len(matrix)) - matrix @ inverse, np.float64)
