"""Axes that go home together on a board's image: switches at the chip's pins, places by the steps it has made."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

import trochia
from trochia.backends.avr.live_avr import LiveAvr
from trochia.backends.avr.transports import ChipTransport
from trochia.backends.avr.wiring import BOARDS
from trochia.backends.switches import switches_of
from trochia.controller.runtime import Runtime
from trochia.machine.homing import Homing
from trochia.machine.io import Channel
from trochia.messages import command as c

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

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
    machine: Machine, chip_program: Path, board_image: Callable[[str], Path]
) -> None:
    line = ChipTransport(chip_program, board_image("uno-stepdir-1000000"), mcu=BOARDS["uno-stepdir"].mcu)
    backend = LiveAvr(machine, line, board="uno-stepdir")
    backend.inputs.follow(switches_of(machine))
    runtime, now, both = Runtime(backend), 0.0, 0

    def until(state: str) -> None:
        nonlocal now, both
        while True:
            now = round(now + 0.005, 9)
            runtime.turn(now)
            it = runtime.controller
            both += int((np.abs(it.report.velocity) > 1.0).sum() >= 2)
            assert it.state.value != "alarm", it.alarms.latched
            assert now < 60.0, it.state
            if it.state.value == state:
                return

    assert runtime.command(c.Enable(), now).ok
    until("idle")
    assert runtime.command(c.Home(), now).ok
    until("idle")
    assert both > 100
    assert all(axis.trusted for axis in runtime.status.axes)
    # on the simulated chip the steps made since power-up are where the machine really is
    steps = np.array(backend.status["position"][:3], float)
    np.testing.assert_allclose(steps * STEP, [REST - 11.0, REST - 7.0, REST - 14.0], atol=0.02)
    runtime.close()
