"""What a machine's channels and windings are on a board."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

import trochia
from trochia.backends.avr.windings import bits, windings
from trochia.backends.avr.wiring import BOARDS, wire
from trochia.backends.live import Orders
from trochia.errors import ConfigError
from trochia.kernels.link import PUT
from trochia.machine.io import Channel
from trochia.machine.joints import Stepper

if TYPE_CHECKING:
    from trochia.machine.machine import Machine


def stage(excitation: str, microsteps: int) -> Machine:
    made = trochia.load("shield-stage")
    motor = Stepper(full_steps=200, microsteps=microsteps, library="SM-42BYG011-25")
    return replace(
        made,
        io=(Channel(name="lamp", kind="latched", pin=1),),
        joints=tuple(
            replace(joint, motor=motor, driver=replace(joint.driver, excitation=excitation), pulse_rate=None)
            for joint in made.joints
        ),
    )


@pytest.mark.parametrize(
    ("excitation", "microsteps", "number"),
    [
        ("one-phase", 1, 0),
        ("two-phase", 1, 1),
        ("half-step", 2, 2),
        ("microstep-table", 16, 3),
        ("microstep-16", 16, 3),
    ],
)
def test_the_machines_excitation_is_what_the_board_is_told(excitation: str, microsteps: int, number: int):
    machine = stage(excitation, microsteps)
    assert windings(machine) == number << 2 | number << 4
    wiring = wire(machine, BOARDS["uno-l293d"])
    assert wiring.levels({"lamp": 1.0}) == number << 2 | number << 4 | 2
    put = wiring.put(Orders(enable=True), {"lamp": 0.0})
    assert list(put) == [1, 255, 0xFC, windings(machine)]
    assert PUT.itemsize == len(put)


def test_a_motor_of_no_excitation_is_released():
    assert bits([None, None]) == 0b1100_0000
    assert bits([2, None]) == 0b1000_1000


def test_an_excitation_that_the_board_has_not_is_refused():
    with pytest.raises(ConfigError, match=r"joints.X.driver.excitation: the board cannot excite by microstep-8"):
        wire(stage("microstep-8", 8), BOARDS["uno-l293d"])


def test_boards_with_drivers_have_no_windings():
    wiring = wire(stage("microstep-8", 8), BOARDS["uno-stepdir"])
    assert (wiring.windings, wiring.mask) == (0, 0)
