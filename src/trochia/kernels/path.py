"""Face of ``core/host/path.h``: moves into a path, and a path's points and extents.

In: rows of ``MOVE``; or a path's segments and coefficients.  Out: segments and coefficients; positions; bounds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trochia.kernels.layout import MOVE, PHASE, SEGMENT, ffi, lib, pointer
from trochia.kernels.spline import PIECE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

_ROOM = {1: (3, 10), 2: (6, 22)}  #: segments, and coefficients an axis, that a move may need
_NINE = 9
_FAULTS = {0: None, 1: "feed", 2: "spindle", 3: "spline", 4: "axis"}


class Room:
    """Memory that one path after another is built in: each is gone when the next is built.

    Attributes
    ----------
    keeper
        Who gives the memory for so many coefficients, and may keep what is built there; None: the room's own.
    """

    __slots__ = ("keeper", "pool", "segments")

    def __init__(self) -> None:
        self.segments: NDArray[np.void] = np.empty(0, dtype=SEGMENT)
        self.pool: NDArray[np.float64] = np.empty(0)
        self.keeper: Callable[[int], NDArray[np.float64]] | None = None

    def reserve(self, moves: int, axes: int, continuity: int) -> None:
        """Have room for what any so many moves may need."""
        most, rows = _ROOM[continuity]
        self.take(most * moves, (7 + rows * axes) * moves)

    def take(self, segments: int, pool: int) -> None:
        """Have room for so many segments and coefficients."""
        if len(self.segments) < segments:
            self.segments = np.empty(segments, dtype=SEGMENT)
        if self.keeper is not None:
            self.pool = self.keeper(pool)
        elif len(self.pool) < pool:
            self.pool = np.empty(pool)


def build(
    moves: NDArray[np.void],
    rests: NDArray[np.uint8],
    *,
    start: NDArray[np.float64],
    columns: Sequence[int],
    tolerance: float,
    continuity: int = 1,
    overlap: bool = False,
    limits: NDArray[np.float64] | None = None,
    splines: tuple[NDArray[np.void], NDArray[np.uint64], float] | None = None,
    absent: Sequence[int] = (),
    room: Room | None = None,
    first_row: int = 0,
) -> tuple[NDArray[np.void], NDArray[np.float64], int, tuple[str, int] | None]:
    """Return the segments and coefficients of a program's moves, how many were merged, and what stopped the work.

    Parameters
    ----------
    moves
        Rows of MOVE (moves,).
    rests
        1 where motion is at rest before the move (moves,).
    start
        Position before the first move (9,).
    columns
        Which of the nine letters the path's axes are, rising.
    tolerance
        Of G64 without P [mm]; negative: no blends at all.
    continuity
        1: x' is continuous between stops; 2: x'' too.
    overlap
        With continuity 2: corners of lines may be overlaps of moves, at whose ends x'' jumps along x'.
    limits
        Velocity, acceleration and jerk of each column (3, axes), infinite where there is none: blends beside slow moves
        are then no longer than these need.
    splines
        What :func:`trochia.kernels.spline.fit` returns, and the tolerance it was given [mm].
    absent
        Which of the nine letters must not move.
    room
        Where the path is built; None: in memory of its own.
    first_row
        Number of the first of the moves since the program's start.

    Returns
    -------
    tuple
        Segments (k,), coefficients, number of moves that others stand for, and None or ("feed" | "spindle" | "spline" |
        "axis", row of the move that has no speed, no such spline, or asks for a letter that is absent).
    """
    if moves.dtype != MOVE or rests.shape != moves.shape or start.shape != (_NINE,):
        raise ValueError("a path is built from MOVE rows, as many rests, and a start of nine axes")
    if (
        not 1 <= len(columns) <= _NINE
        or list(columns) != sorted(set(columns))
        or not 0 <= min(columns) <= max(columns) < _NINE
    ):
        raise ValueError(f"columns must be rising numbers of letters, not {columns!r}")
    axes, count = len(columns), len(moves)
    if continuity not in _ROOM:
        raise ValueError(f"continuity is 1 or 2, not {continuity!r}")
    most, rows = _ROOM[continuity]
    given = ffi.new("trochia_path_input *")
    curves = count
    if splines is not None:
        pieces, first, given.spline_error = splines
        if pieces.dtype != PIECE or first.dtype != np.uint64 or not first.size or first[-1] != len(pieces):
            raise ValueError("splines are PIECE rows, and where each curve's begin")
        given.spline_count, given.pieces = first.size - 1, pointer(pieces, "trochia_spline_piece *")
        given.first_piece = pointer(first, "uint64_t *")
        curves += _piece_count(moves, first)
    own = room or Room()
    own.take(most * curves, (7 + rows * axes) * curves)
    made = ffi.new("trochia_path_output *")
    flags = np.ascontiguousarray(rests, dtype=np.uint8)
    given.moves, given.rests = pointer(moves, "trochia_move *"), pointer(flags, "uint8_t *")
    given.count, given.axes, given.tolerance, given.continuity = count, axes, tolerance, continuity
    given.overlap, given.first_row = overlap, first_row
    if limits is not None:
        if limits.shape != (3, axes) or not (limits > 0.0).all():
            raise ValueError("limits are positive, (3, axes)")
        given.paced = 1
        for field, row in zip((given.slowness, given.effort, given.shake), 1.0 / limits, strict=True):
            field[0:axes] = list(row)
    given.start = list(start)
    given.columns = list(columns) + [0] * (_NINE - axes)
    given.absent_count, given.absent = len(absent), list(absent) + [0] * (_NINE - len(absent))
    made.segments, made.pool = pointer(own.segments, "trochia_segment *"), pointer(own.pool, "double *")
    fault = _FAULTS[lib.trochia_path_build(given, made)]
    if room is None:
        own.segments.resize(made.segment_count, refcheck=False)
        own.pool.resize(made.pool_count, refcheck=False)
    segments, pool = own.segments[: made.segment_count], own.pool[: made.pool_count]
    return segments, pool, int(made.merged_count), (fault, int(made.failed_move)) if fault else None


def _piece_count(moves: NDArray[np.void], first: NDArray[np.uint64]) -> int:
    """Return how many pieces the moves that are splines have together."""
    rows = moves["turns"][moves["kind"] == lib.TROCHIA_SPLINE]
    rows = rows[(rows >= 0) & (rows < first.size - 1)]
    return int((first[rows + 1] - first[rows]).sum())


def check(segments: NDArray[np.void], pool: NDArray[np.float64], axes: int) -> None:
    """Refuse segments whose coefficients lie outside the pool or whose arc plane is no axis (ValueError)."""
    if segments.dtype != SEGMENT or pool.dtype != np.float64 or not 1 <= axes <= _NINE:
        raise ValueError("a path is SEGMENT rows and a pool of doubles in one to nine axes")
    fault = lib.trochia_path_check(pointer(segments, "trochia_segment *"), len(segments), pool.size, axes)
    if fault == 1:
        raise ValueError("a segment's coefficients lie outside the pool")
    if fault:
        raise ValueError("a segment of unknown kind, or an arc in a plane that is not there")


def append(
    segments: NDArray[np.void],
    moves: NDArray[np.void],
    into: tuple[NDArray[np.void], NDArray[np.uint32], NDArray[np.float32]],
    *,
    shift: int,
    first: int,
) -> None:
    """Copy segments, and line and power of their moves, into as many rows behind those of the same path.

    Parameters
    ----------
    segments
        Rows of SEGMENT (k,).
    moves
        Rows of MOVE that they belong to.
    into
        Segments, lines, power (k,) each.
    shift
        How far their coefficients have moved in the pool.
    first
        Number of the first of ``moves``.
    """
    rows, lines, power = into
    if not len(segments) == len(rows) == len(lines) == len(power):
        raise ValueError("as many rows as segments")
    if len(segments) and int(segments["move"].max()) >= len(moves):
        raise ValueError("segments of moves that are not there")
    lib.trochia_path_append(
        pointer(segments, "trochia_segment *"), len(segments), shift % 2**64, first, pointer(moves, "trochia_move *"),
        pointer(rows, "trochia_segment *"), pointer(lines, "uint32_t *"), pointer(power, "float *"),
    )  # fmt: skip


def reach(segments: NDArray[np.void], seconds: float, *, feed: float, most: float) -> tuple[int, float]:
    """Return how many segments, from the first on, take some seconds together, and what is left of these.

    Parameters
    ----------
    segments
        Rows of SEGMENT (k,); where all take less, all count.
    seconds
        At the segments' own speeds [s].
    feed, most
        What these are scaled by, and the greatest there is.
    """
    left = ffi.new("double *", seconds)
    rows = lib.trochia_path_reach(pointer(segments, "trochia_segment *"), len(segments), feed, most, left)
    return int(rows), float(left[0])


def move_phases(phases: NDArray[np.void], into: NDArray[np.void], *, later: float = 0.0, rows: int = 0) -> None:
    """Copy phases into as many others (or themselves), later by so much [s] and on segments so many rows further on."""
    if not phases.dtype == into.dtype == PHASE or len(phases) != len(into):
        raise ValueError("as many rows of PHASE as there are phases")
    lib.trochia_phases_move(
        pointer(phases, "trochia_phase *"), len(phases), later, rows % 2**32, pointer(into, "trochia_phase *")
    )


def sample(
    segments: NDArray[np.void], pool: NDArray[np.float64], axes: int, states: NDArray[np.void], order: int
) -> NDArray[np.float64]:
    """Return the time derivative of position of the given order (0 to 3) at each state (states, axes)."""
    if states.dtype != PHASE or not 0 <= order <= 3 or (states.size and int(states["segment"].max()) >= segments.size):
        raise ValueError("states are PHASE rows on the path's segments, orders 0 to 3")
    out = np.empty((len(states), axes))
    held = np.ascontiguousarray(states)
    lib.trochia_path_sample(
        pointer(segments, "trochia_segment *"), pointer(pool, "double *"), axes,
        pointer(held, "trochia_phase *"), len(states), order, pointer(out, "double *"),
    )  # fmt: skip
    return out


def extents(
    segments: NDArray[np.void], pool: NDArray[np.float64], rows: tuple[int, int], bounds: NDArray[np.float64]
) -> None:
    """Widen bounds (2, axes) [least; greatest] by the segments rows[0] up to rows[1], exactly."""
    axes, (first, last) = bounds.shape[-1], rows
    if bounds.shape != (2, axes) or not 0 <= first <= last <= segments.size:
        raise ValueError("bounds are (2, axes), segments lie in the path")
    least: Any = pointer(bounds, "double *")
    lib.trochia_path_extents(
        pointer(segments, "trochia_segment *"), pointer(pool, "double *"), axes, first, last, least, least + axes
    )
