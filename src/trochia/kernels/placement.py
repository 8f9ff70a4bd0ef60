"""Rows of the G-code reader into moves of the machine: the face of ``core/host/placement.h``.

machine = (turn(program + shift) + origin) * scale, with ``turn`` about Z and ``scale`` the length of a program unit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, cast

from trochia.kernels.layout import MOVE, ffi, lib, pointer

if TYPE_CHECKING:
    from collections.abc import MutableSequence

    from numpy.typing import NDArray


class Placement(Protocol):
    """The C struct ``trochia_placement``: what a row does not say itself.

    ``origin`` (9,) and ``shift`` (9,) [program unit, degree], ``scale`` [mm], ``cosine`` and ``sine`` of the turn,
    ``feed`` as F gave it and ``feed_scale``, the length of the unit it counts in [mm], ``tolerance`` (2,) [mm],
    ``speed`` as S gave it, ``new_speed`` once a row gave another, ``fills`` whether moves get it as power (0 where
    not ``lit``), ``position`` (9,) before the next row [mm, degree], ``plane``, ``law``, ``path_mode``.
    """

    origin: MutableSequence[float]
    shift: MutableSequence[float]
    scale: float
    cosine: float
    sine: float
    feed: float
    feed_scale: float
    speed: float
    tolerance: MutableSequence[float]
    position: MutableSequence[float]
    plane: int
    law: int
    path_mode: int
    fills: int
    lit: int
    new_speed: int


def new_placement() -> Placement:
    """Return a placement that changes nothing: millimetres, no offsets, XY, feed per minute."""
    return cast("Placement", ffi.new("trochia_placement *", {"scale": 1.0, "cosine": 1.0, "feed_scale": 1.0}))


def place(rows: NDArray[Any], placement: Placement, out: NDArray[Any]) -> int:
    """Write the moves that rows (rows,) stand for to ``out`` (at least as many); return their number.

    Both are arrays of ``MOVE``.  Rows that are no move are left out; ``placement.position``, ``feed`` and
    ``feed_scale`` are moved on.
    """
    if rows.dtype != MOVE or out.dtype != MOVE:
        raise ValueError(f"rows and moves are of the type of a move, not {rows.dtype} and {out.dtype}")
    if len(out) < len(rows):
        raise ValueError(f"{len(rows)} rows need as much room, not {len(out)}")
    if not 0 <= placement.plane <= 2:
        raise ValueError(f"there is no plane {placement.plane}")
    return lib.trochia_place(pointer(rows, "trochia_move *"), len(rows), placement, pointer(out, "trochia_move *"))
