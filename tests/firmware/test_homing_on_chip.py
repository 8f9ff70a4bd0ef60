"""Axes that go home together on a board's image: switches at the chip's pins, places by the steps it has made."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import trochia
from trochia.machine.homing import Homing
from trochia.machine.io import Channel
from trochia.messages import command as c

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.machine.machine import Machine

STEP = 0.005  # mm
REST = 4.0  # mm


@pytest.fixture
def machine() -> Machine:
    """A mill whose switches are -11, -7 and -14 mm from where it is switched on."""
    made = trochia.load("reference-mill")
    axes = tuple(
        replace(
            axis,
            minimum=-at - 1.0,
            maximum=100.0,
            home=Homing(input=f"home-{axis.name}", position=-at, rest=REST - at, search=15.0),
        )
        for axis, at in zip(made.axes, (11.0, 7.0, 14.0), strict=True)
    )
    return replace(made, axes=axes, io=tuple(Channel(name=f"home-{axis.name}", kind="input") for axis in axes))


def test_all_axes_are_homed_at_once_and_stand_where_their_switches_say(
    machine: Machine, chip_bench: Callable[[Machine], Any]
) -> None:
    b = chip_bench(machine)
    b.ok(c.Home())
    b.until("idle")
    assert sum(int((velocity > 1.0).sum() >= 2) for velocity in b.velocities) > 100
    assert all(axis.trusted for axis in b.runtime.status.axes)
    # on the simulated chip the steps made since power-up are where the machine really is
    np.testing.assert_allclose(b.steps() * STEP, [REST - 11.0, REST - 7.0, REST - 14.0], atol=0.02)
