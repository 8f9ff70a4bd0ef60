"""The least time along a given path with limited velocity, acceleration and jerk: what a plan is held against.

With b = v² over s, acceleration q'' b + q' b'/2 is linear in b, and its change from interval to interval may be at most
J Δs / √b.  The last is not convex: the tangent of 1 / √b lies below it, so a linear programme with that tangent has
only allowed motions, among them the one the tangent was taken at; solved again and again its time only falls.

In: a path that ds/dt may follow without stops but where it says, its limits, and a motion to begin with.
Out: a time that can be reached (but for the grid): at or above the least; nothing proves that no other valley is lower.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from trochia.planner import Trajectory
    from trochia.planner.limits import Limits
    from trochia.toolpath import Toolpath

    Array = NDArray[np.float64]

DIRECTIONS = 24  #: of the half circle, in which a cap on the vector is looked at: 0.2 % too wide at most
TANGENTS = (0.3, 0.5, 0.7, 0.85, 0.95, 1.0, 1.05, 1.2, 1.5, 2.0, 3.0)  #: of 1/√b, as parts of the last b
SLOWER = 0.9  #: part of a planned motion's speed that rounds begin with
PLACES = 300  #: intervals of a long path, at least
LEAST = 1e-5  #: part of a round's gain below which no other follows


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """A part of a path between two stops, cut into intervals.

    ``s`` (n + 1,) [mm]; of each interval's middle ``along`` and ``bend`` (n, rows), q' and q'' of every limited row;
    ``most`` (n + 1,) v² that velocity limits, feeds and centripetal acceleration leave; ``acceleration``, ``jerk``
    of each row (rows,).
    """

    s: Array
    along: Array
    bend: Array
    most: Array
    acceleration: Array
    jerk: Array


def rows_of(limits: Limits) -> tuple[Array, Array, Array, Array]:
    """Return matrix (rows, axes), velocity, acceleration and jerk of all rows, a vector's caps as directions of X Y."""
    caps = (limits.path_velocity, limits.path_acceleration, limits.path_jerk)
    matrix, bounds = limits.matrix, [limits.velocity, limits.acceleration, limits.jerk]
    if np.isfinite(caps).any():
        angles = np.arange(DIRECTIONS) * np.pi / DIRECTIONS
        around = np.zeros((DIRECTIONS, matrix.shape[1]))
        around[:, 0], around[:, 1] = np.cos(angles), np.sin(angles)
        matrix = np.concatenate([matrix, around])
        bounds = [np.concatenate([b, np.full(DIRECTIONS, cap)]) for b, cap in zip(bounds, caps, strict=True)]
    return matrix, bounds[0], bounds[1], bounds[2]


def grids(path: Toolpath, limits: Limits, step: float) -> list[Grid]:
    """Return the parts of a path between its stops, cut to steps of `step` mm and to fifths of a segment."""
    stops = np.flatnonzero(path.segments["stop"]) + 1
    return [_grid(path, limits, int(a), int(b), step) for a, b in pairwise([0, *stops.tolist()]) if b > a]


def _grid(path: Toolpath, limits: Limits, first: int, after: int, step: float) -> Grid:
    lengths = path.segments["length"][first:after]
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    whole = float(starts[-1])
    step = max(step, whole / PLACES)  # longer on long ones
    near = min(0.5 * whole, 60.0 * step) * np.linspace(0.0, 1.0, 60) ** 3  # b grows as s^(4/3) from rest
    s = np.concatenate(
        [
            near,
            whole - near,
            *(
                a + (b - a) * np.linspace(0.0, 1.0, max(int(np.ceil((b - a) / step)), 5) + 1)
                for a, b in pairwise(starts)
            ),
        ]
    )
    s = np.unique(np.clip(s, 0.0, whole))
    s = s[np.concatenate([[True], np.diff(s) > 1e-7])]
    s[-1] = whole
    matrix, velocity, acceleration, jerk = rows_of(limits)
    middle = 0.5 * (s[1:] + s[:-1])
    row = np.clip(np.searchsorted(starts, middle, "right") - 1, 0, len(lengths) - 1)
    along = path.points(first + row, middle - starts[row], 1) @ matrix.T
    bend = path.points(first + row, middle - starts[row], 2) @ matrix.T
    with np.errstate(divide="ignore"):
        most = np.minimum(((velocity / np.abs(along)).min(axis=1)) ** 2, path.segments["speed_limit"][first + row] ** 2)
        pull = (jerk / np.abs(along)).min(axis=1)
    for end in (0, -1):  # from rest, by constant jerk
        step = float(s[1] - s[0] if end == 0 else s[-1] - s[-2])
        most[end] = min(most[end], 0.25 * pull[end] ** 2 * (6.0 * step / pull[end]) ** (4.0 / 3.0))
    return Grid(
        s=s,
        along=along,
        bend=bend,
        most=np.minimum(np.append(most, np.inf), np.append(np.inf, most)),
        acceleration=acceleration,
        jerk=jerk,
    )


def time_of(s: Array, b: Array) -> float:
    """Return the time over a grid [s] between two rests; v = c s^(2/3) in the two outermost intervals."""
    v = np.sqrt(b)
    inner = (2.0 * np.diff(s) / (v[1:] + v[:-1]))[1:-1].sum()
    return float(inner + 3.0 * (s[1] - s[0]) / v[1] + 3.0 * (s[-1] - s[-2]) / v[-2])


def _linear(grid: Grid) -> tuple[sparse.csr_matrix, Array, sparse.csr_matrix]:
    """Return what of b is each row's acceleration in each interval (n·rows, n - 1), its limit, and its changes."""
    h = np.diff(grid.s)
    n, rows = grid.along.shape
    lower = 0.5 * grid.bend - 0.5 * grid.along / h[:, None]
    upper = 0.5 * grid.bend + 0.5 * grid.along / h[:, None]
    at = np.arange(n * rows).reshape(n, rows)
    index = np.repeat(np.arange(n)[:, None], rows, axis=1)
    columns = sparse.csr_matrix(
        (
            np.concatenate([lower.ravel(), upper.ravel()]),
            (np.tile(at.ravel(), 2), np.concatenate([index.ravel(), index.ravel() + 1])),
        ),
        shape=(n * rows, n + 1),
    )
    inner = columns[:, 1:-1].tocsr()
    keep = np.isfinite(np.tile(grid.acceleration, n))
    changes = inner[rows:] - inner[:-rows]
    return inner[keep], np.tile(grid.acceleration, n)[keep], changes.tocsr()


def _share(s: Array) -> Array:
    """Return (n - 1,) what part of J Δs / √b differences of b show under even jerk from rest, b = 9 s^(4/3), J = 6."""
    b = 9.0 * s ** (4.0 / 3.0)
    mean = 0.5 * np.diff(b) / np.diff(s)
    return np.diff(mean) * np.sqrt(b[1:-1]) / (3.0 * (s[2:] - s[:-2]))


def _round(grid: Grid, b: Array, parts: tuple[sparse.csr_matrix, Array, sparse.csr_matrix]) -> Array | None:
    """Return b (n - 1,) of least time under the tangents at b, or None where the solver gives none."""
    inner, limit, changes = parts
    count, rows = len(b), grid.along.shape[1]
    s = grid.s
    way = 0.5 * (s[2:] - s[:-2])
    value, slope = b**-0.5, -0.5 * b**-1.5
    keep = np.isfinite(np.tile(grid.jerk, count))
    of = np.repeat(np.arange(count), rows)[keep]
    jerk = np.tile(grid.jerk, count)[keep] * np.minimum(_share(s), _share(s[-1] - s[::-1])[::-1])[of]
    tangent = sparse.csr_matrix((-jerk * (way * slope)[of], (np.arange(len(of)), of)), shape=(len(of), count))
    right = jerk * (way * (value - slope * b))[of]
    changes = changes[keep]
    unit = sparse.eye(count, format="csr")
    below = [sparse.hstack([sparse.diags(-0.5 * (t * b) ** -1.5), -unit]) for t in TANGENTS]
    offs = [-1.5 * (t * b) ** -0.5 for t in TANGENTS]
    zero = sparse.csr_matrix((len(limit), count))
    empty = sparse.csr_matrix((len(of), count))
    left = sparse.vstack(
        [
            sparse.hstack([inner, zero]),
            sparse.hstack([-inner, zero]),
            sparse.hstack([changes + tangent, empty]),
            sparse.hstack([-changes + tangent, empty]),
            *below,
        ],
        format="csr",
    )
    scale = np.concatenate([b, b**-0.5])  # unknowns near 1
    weight = way.copy()
    weight[0] = 0.5 * (s[2] - s[1]) + 3.0 * (s[1] - s[0])
    weight[-1] = 0.5 * (s[-2] - s[-3]) + 3.0 * (s[-1] - s[-2])
    left = left @ sparse.diags(scale)
    right = np.concatenate([limit, limit, right, right, *offs])
    size = abs(left).max(axis=1).toarray().ravel()
    used = size > 0.0  # of rows that stand still nothing is asked
    left, right, size = left[used], right[used], size[used]
    found = linprog(
        np.concatenate([np.zeros(count), weight * b**-0.5]),
        A_ub=sparse.diags(1.0 / size) @ left,
        b_ub=right / size,
        bounds=np.stack(
            [
                np.concatenate([np.full(count, 0.1), np.zeros(count)]),
                np.concatenate([grid.most[1:-1] / b, np.full(count, np.inf)]),
            ],
            axis=1,
        ),
        method="highs-ipm",
    )
    values: Array | None = found.x
    return None if values is None or found.status != 0 else values[:count] * b


def least_time(grid: Grid, speed: Array, rounds: int = 25) -> float:
    """Return the time [s] that rounds come to from v at the grid's inner places (n - 1,); infinite where they fail."""
    parts = _linear(grid)
    b, best = np.minimum(speed**2, grid.most[1:-1]), np.inf
    for _ in range(rounds):
        found = _round(grid, b, parts)
        if found is None:
            break
        time = time_of(grid.s, np.concatenate([[0.0], found, [0.0]]))
        if time > best * (1.0 - LEAST):
            return min(best, time)
        b, best = found, time
    return best


def speed_on(path: Toolpath, trajectory: Trajectory, every: float = 2e-4) -> tuple[Array, Array]:
    """Return s of a path, counted from its beginning, and v there, of a planned motion."""
    starts = np.concatenate([[0.0], np.cumsum(path.segments["length"])])
    states = trajectory.states(np.arange(0.0, trajectory.duration, every))
    moving = states["v"] > 0.0
    s = starts[states["segment"]] + states["s"]
    return s[moving], states["v"][moving]


def third_order(path: Toolpath, limits: Limits, trajectory: Trajectory, step: float = 0.1) -> float:
    """Return the least time [s] found along a path that rests where the path does, beginning with a planned motion."""
    place, speed = speed_on(path, trajectory)
    total, begin = 0.0, 0.0
    for grid in grids(path, limits, step):
        v = np.maximum(np.interp(begin + grid.s[1:-1], place, speed), 1e-3)
        begin += float(grid.s[-1])
        total += least_time(grid, SLOWER * v)
    return total
