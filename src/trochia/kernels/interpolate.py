"""Face of ``core/shared/interpolate.h``: whole figures through the classic interpolators.

In: method number and figure in whole steps.  Out: a pulse byte a tick (directions in bits 0 and 1, clocks in 2 and 3).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray

GREATEST = 2**30 - 1  #: coordinates and radii a figure may have [steps]
METHODS: dict[str, int] = {
    "dda": lib.TROCHIA_DDA,
    "bresenham": lib.TROCHIA_BRESENHAM,
    "point": lib.TROCHIA_POINT,
    "difference": lib.TROCHIA_DIFFERENCE,
    "octant": lib.TROCHIA_OCTANT,
}
_CHUNK = 1 << 16


def _run(state: Any) -> NDArray[np.uint8]:  # noqa: ANN401 - a cffi pointer has no Python type
    """Return the pulse bytes of a figure that has begun."""
    parts: list[NDArray[np.uint8]] = []
    while True:
        part = np.empty(_CHUNK, dtype=np.uint8)
        made = lib.trochia_interpolate(state, _CHUNK, pointer(part, "uint8_t *"))
        parts.append(part[:made])
        if made < _CHUNK:
            return np.concatenate(parts)


def _check(*coordinates: int) -> None:
    if max(map(abs, coordinates)) > GREATEST:
        raise ValueError(f"coordinates must stay within {GREATEST} steps")


def line_pulses(method: int, x: int, y: int) -> NDArray[np.uint8]:
    """Return the pulse bytes of a line from (0, 0) to (x, y) [steps]."""
    _check(x, y)
    state = ffi.new("trochia_interpolator *")
    lib.trochia_begin_line(state, method, x, y)
    return _run(state)


def arc_pulses(
    method: int, start: tuple[int, int], end: tuple[int, int], radius_squared: int, *, clockwise: bool
) -> NDArray[np.uint8]:
    """Return the pulse bytes of an arc about (0, 0) [steps]; a whole turn where start and end are one point.

    Raises
    ------
    ValueError
        For a point at the centre or coordinates out of range.  That both points lie on the circle is the caller's care.
    """
    _check(*start, *end)
    if not 0 < radius_squared <= GREATEST**2 or start == (0, 0) or end == (0, 0):
        raise ValueError("an arc has a radius above zero, and its ends are not its centre")
    state = ffi.new("trochia_interpolator *")
    lib.trochia_begin_arc(state, method, clockwise, radius_squared, *start, *end)
    return _run(state)
