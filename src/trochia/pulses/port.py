"""Pulses as bytes of a parallel port: five of its eight data bits.

bit 0 X direction, bit 1 Y direction (1 = forwards), bit 2 X clock, bit 3 Y clock, bit 4 shutter (1 = open).  A step is
three bytes, directions first, then the clocks up, then down again, so that set-up and hold are kept by the bytes' rate.
"""

from __future__ import annotations

from enum import IntFlag
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class PortBit(IntFlag):
    """Bits of the port; an interpolator's pulse is the first four of them."""

    X_FORWARDS = 1
    Y_FORWARDS = 2
    X_CLOCK = 4
    Y_CLOCK = 8
    SHUTTER = 16


DIRECTIONS = PortBit.X_FORWARDS | PortBit.Y_FORWARDS
CLOCKS = PortBit.X_CLOCK | PortBit.Y_CLOCK


def port_bytes(pulses: ArrayLike, *, beam: bool = False) -> NDArray[np.uint8]:
    """Return the port's bytes for the pulses of successive ticks (ticks,): (3 ticks,).

    Raises
    ------
    ValueError
        For a pulse with other bits than directions and clocks.
    """
    given = np.asarray(pulses, dtype=np.uint8)
    if (given & ~np.uint8(DIRECTIONS | CLOCKS)).any():
        raise ValueError("a pulse has two direction bits and two clock bits, no others")
    lit = np.uint8(PortBit.SHUTTER if beam else 0)
    still = given & np.uint8(DIRECTIONS) | lit
    return np.stack((still, given | lit, still), axis=-1).reshape(-1)
