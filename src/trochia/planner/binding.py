"""Which limit binds.  In: states along a path and its limits.  Out: for each the limit that is used most, and how much.

Speed v, acceleration a and jerk j along s make of a limited quantity q the velocity q' v, the acceleration
q'' v² + q' a and the jerk q''' v³ + 3 q'' v a + q' j.  Each over its limit is how much is used; the greatest binds.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels import path as kernel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from trochia.planner.limits import Limits
    from trochia.toolpath import Toolpath

    Floats = NDArray[np.float64]

ROWS = 32  #: a code is kind x ROWS + row of the limits
_RESTING = 1
_HALF = 0.5


class Kind(IntEnum):
    """What kind of limit binds."""

    REST = 0  #: a dwell, the spindle, a tool change: nothing moves
    FEED = 1  #: the programmed feed
    VELOCITY = 2  #: velocity of an axis or joint
    ACCELERATION = 3  #: its acceleration, most of it along the path
    CURVATURE = 4  #: its acceleration, most of it (or of its jerk) from the path's bend
    JERK = 5  #: its jerk
    PATH_VELOCITY = 6  #: the machine's cap on the vector's speed
    PATH_ACCELERATION = 7  #: on its acceleration
    PATH_JERK = 8  #: on its jerk
    DRIVE = 9  #: the least time a segment may take at the drive
    SHAPER = 10  #: input shaping, which ends motion later


_WORDS = {
    Kind.REST: "at rest",
    Kind.FEED: "programmed feed",
    Kind.VELOCITY: "{} velocity",
    Kind.ACCELERATION: "{} acceleration",
    Kind.CURVATURE: "{} acceleration in a bend",
    Kind.JERK: "{} jerk",
    Kind.PATH_VELOCITY: "path velocity cap",
    Kind.PATH_ACCELERATION: "path acceleration cap",
    Kind.PATH_JERK: "path jerk cap",
    Kind.SHAPER: "input shaping",
    Kind.DRIVE: "least time of a segment at the drive",
}


def word(code: int, names: Sequence[str]) -> str:
    """Return what a person calls a binding limit, like ``axis X acceleration``; ``names`` are those of the limits."""
    kind, row = divmod(code, ROWS)
    return _WORDS[Kind(kind)].format(names[row])


@dataclass(frozen=True, slots=True, kw_only=True)
class Binding:
    """The limit that binds at each of some instants.

    Attributes
    ----------
    kind, row
        What kind (n,) of :class:`Kind`, and of which row of the limits (n,), 0 where it is of no row.
    used
        How much of it is used (n,), 1 all; 0 at rest.
    names
        Of the rows.
    """

    kind: NDArray[np.uint8]
    row: NDArray[np.uint8]
    used: Floats
    names: tuple[str, ...]

    @classmethod
    def of_rest(cls, count: int, names: tuple[str, ...]) -> Binding:
        """Return that nothing moves at any of ``count`` instants."""
        none = np.zeros(count, dtype=np.uint8)
        return cls(kind=none, row=none, used=np.zeros(count), names=names)

    @property
    def code(self) -> NDArray[np.intp]:
        """One number for kind and row (n,)."""
        return self.kind.astype(np.intp) * ROWS + self.row

    def words(self) -> list[str]:
        """Return each in words (n,)."""
        return [word(code, self.names) for code in self.code.tolist()]


def bind(path: Toolpath, limits: Limits, states: NDArray[Any], *, jerk: bool, curves: bool = False) -> Binding:
    """Return what binds in each state (PHASE rows).

    Parameters
    ----------
    jerk
        Whether the profile limits jerk.
    curves
        Whether it follows curves of acceleration by speed; others keep the least of such a curve.
    """
    found = _Most(len(states))
    v, a, j = (states[name][:, None] for name in ("v", "a", "j"))
    shape = states.copy()
    shape["v"], shape["a"], shape["j"] = 1.0, 0.0, 0.0
    orders = range(1, 4 if jerk else 3)
    along = [kernel.sample(path.segments, path.pool, len(path.axes), shape, order) for order in orders]
    axes = along[0] * v, along[1] * v * v + along[0] * a
    bends = [along[1] * v * v]
    if jerk:
        bends.append(along[2] * v**3 + 3.0 * along[1] * v * a)
        axes += (bends[1] + along[0] * j,)
    speed = states["v"]
    found.see(Kind.FEED, speed / path.segments["speed_limit"][states["segment"]])
    if limits.segment_time > 0.0:
        found.see(Kind.DRIVE, speed * limits.segment_time / path.segments["length"][states["segment"]])
    rows = [values @ limits.matrix.T for values in axes]
    found.rows(Kind.VELOCITY, np.abs(rows[0]) / limits.velocity)
    bounds = [limits.acceleration_at(rows[0]) if curves else limits.acceleration, limits.jerk]
    for kind, values, bend, bound in zip((Kind.ACCELERATION, Kind.JERK), rows[1:], bends, bounds, strict=False):
        found.rows(kind, np.abs(values) / bound, bent=np.abs(bend @ limits.matrix.T) > _HALF * np.abs(values))
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    for kind, values, cap in zip(
        (Kind.PATH_VELOCITY, Kind.PATH_ACCELERATION, Kind.PATH_JERK), axes, caps, strict=False
    ):
        if np.isfinite(cap):
            found.see(kind, np.linalg.norm(values[:, : limits.linear], axis=1) / cap)
    return found.binding(states["flags"] & _RESTING == _RESTING, limits.names)


class _Most:
    """The greatest use seen so far, and of what."""

    def __init__(self, count: int) -> None:
        self.used = np.zeros(count)
        self.kind = np.full(count, Kind.FEED, dtype=np.uint8)
        self.row = np.zeros(count, dtype=np.uint8)

    def see(self, kind: Kind, used: Floats) -> None:
        """Take a limit that is of no row (n,) where it is used more."""
        self._take(np.full(len(used), kind), np.zeros(len(used), dtype=np.intp), used)

    def rows(self, kind: Kind, used: Floats, bent: NDArray[np.bool_] | None = None) -> None:
        """Take the row that is used most (n, rows) where it is used more; ``bent``: it is the path's bend."""
        at = np.argmax(used, axis=1)
        take = at[:, None]
        kinds = np.full(len(used), kind)
        if bent is not None:
            kinds[np.take_along_axis(bent, take, axis=1)[:, 0]] = Kind.CURVATURE
        self._take(kinds, at, np.take_along_axis(used, take, axis=1)[:, 0])

    def _take(self, kind: NDArray[Any], row: NDArray[np.intp], used: Floats) -> None:
        more = used > self.used
        self.used[more], self.kind[more], self.row[more] = used[more], kind[more], row[more]

    def binding(self, resting: NDArray[np.bool_], names: tuple[str, ...]) -> Binding:
        """Return it, with nothing but rest where motion rests."""
        self.kind[resting], self.row[resting], self.used[resting] = Kind.REST, 0, 0.0
        return Binding(kind=self.kind, row=self.row, used=self.used, names=names)
