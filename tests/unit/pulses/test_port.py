"""Pulse bytes on the parallel port."""

from __future__ import annotations

import pytest

from trochia.pulses.interpolators import INTERPOLATORS, Line
from trochia.pulses.port import PortBit, port_bytes


@pytest.mark.parametrize(("lit", "expected"), [(0, [0x01, 0x05, 0x01]), (1, [0x11, 0x15, 0x11])])
def test_an_x_step_forwards(lit: int, expected: list[int]) -> None:
    """The source's example: direction, clock up, clock down; with the shutter open on top."""
    pulses = INTERPOLATORS["dda"].pulses(Line(x=1, y=0))
    step = pulses[pulses & PortBit.X_CLOCK > 0]
    assert port_bytes(step, beam=bool(lit)).tolist() == expected


def test_both_axes_backwards() -> None:
    assert port_bytes([PortBit.X_CLOCK | PortBit.Y_CLOCK]).tolist() == [0x00, 0x0C, 0x00]


def test_an_empty_tick_keeps_the_directions_and_waits() -> None:
    assert port_bytes([PortBit.Y_FORWARDS], beam=True).tolist() == [0x12, 0x12, 0x12]


def test_other_bits_are_refused() -> None:
    with pytest.raises(ValueError, match="two direction bits"):
        port_bytes([PortBit.SHUTTER])
