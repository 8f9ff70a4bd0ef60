"""Face of ``core/shared/interpolate.h``: whole figures through the classic interpolators.

In: method number and figure in whole steps.  Out: a pulse byte a tick (directions in bits 0 and 1, clocks in 2 and 3).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trochia.kernels.layout import ffi, lib, pointer

if TYPE_CHECKING:
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


class Begun:
    """A figure set up in the C core, to be run as often as one likes.

    Parameters
    ----------
    method
        One of ``METHODS``' numbers.
    """

    def __init__(self, method: int) -> None:
        self._method = method
        self._state = ffi.new("trochia_interpolator *")

    @classmethod
    def line(cls, method: int, x: int, y: int) -> Begun:
        """Return a line from (0, 0) to (x, y) [steps].

        Raises
        ------
        ValueError
            For coordinates out of range.
        """
        _check(x, y)
        begun = cls(method)
        lib.trochia_begin_line(begun._state, method, x, y)
        return begun

    @classmethod
    def arc(
        cls, method: int, start: tuple[int, int], end: tuple[int, int], radius_squared: int, *, clockwise: bool
    ) -> Begun:
        """Return an arc about (0, 0) [steps]; a whole turn where start and end are one point.

        Raises
        ------
        ValueError
            For a point at the centre or out of range; that both lie on the circle is the caller's care.
        """
        _check(*start, *end)
        if not 0 < radius_squared <= GREATEST**2 or start == (0, 0) or end == (0, 0):
            raise ValueError("an arc has a radius above zero, and its ends are not its centre")
        furthest = max(map(abs, (*start, *end)))
        if furthest * (furthest - 1) >= radius_squared:  # so that furthest is at most the rounded radius
            raise ValueError("an arc's ends lie no further out than where its circle meets the axes")
        begun = cls(method)
        lib.trochia_begin_arc(begun._state, method, clockwise, radius_squared, *start, *end)
        return begun

    def pulses(self) -> NDArray[np.uint8]:
        """Return the pulse byte of each tick (ticks,)."""
        state = ffi.new("trochia_interpolator *", self._state[0])
        parts: list[NDArray[np.uint8]] = []
        while True:
            part = np.empty(_CHUNK, dtype=np.uint8)
            made = lib.trochia_interpolate(state, _CHUNK, pointer(part, "uint8_t *"))
            parts.append(part[:made])
            if made < _CHUNK:
                return np.concatenate(parts)

    def over(self, times: int) -> int:
        """Run the figure ``times`` times, keeping nothing but the sum of the bytes: for timing."""
        return int(lib.trochia_interpolate_over(self._state, times))


def _check(*coordinates: int) -> None:
    """Refuse coordinates the core's integers cannot hold."""
    if max(map(abs, coordinates)) > GREATEST:
        raise ValueError(f"coordinates must stay within {GREATEST} steps")
