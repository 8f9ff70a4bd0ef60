"""The motor shield under the image: the register's bytes and the bridges' duties, held against the Python tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from trochia.backends.avr.windings import bits
from trochia.backends.simulated_chip import PIN
from trochia.pulses.excitation import half_step, table_microstep
from trochia.pulses.latch import latch_byte
from trochia.stepper import BACKWARD, FORWARD, Shield, VirtualTime
from trochia.stepper.shield import Style

if TYPE_CHECKING:
    from collections.abc import Callable

STYLES = list(Style)
INTERVAL = 8000  # ticks: 2,000 steps/s


def duties(style: Style, position: int) -> tuple[int, int]:
    """What the bridges of phases A and B have at a position of a turn."""
    if style is not Style.MICROSTEP:
        return 255, 255
    a, b = table_microstep().levels[position]
    return round(255 * abs(a)), round(255 * abs(b))


def test_at_reset_the_register_is_empty_and_the_bridges_are_off(talk: Callable[[str], Any], register: Any):
    told = talk("uno-l293d")
    told.pass_on(0.2)
    events = told.events()
    register.feed(events)
    assert register.bytes == [0]
    assert register.duties == []
    off = events[(events["kind"] == PIN) & (events["unit"] == b"D") & (events["line"] == 7)]
    assert off["value"].tolist() == [1, 0]  # its outputs off, and on once it holds zeros
    assert int(off["cycle"][1]) > register.latched[0][0]


@pytest.mark.parametrize("port", [1, 2])
@pytest.mark.parametrize("style", STYLES, ids=lambda style: style.name)
def test_every_excitation_byte_by_byte_in_both_directions(
    talk: Callable[[str], Any], register: Any, port: int, style: Style
):
    """Released until the first step, as under the shield's own library."""
    told = talk("uno-l293d")
    numbers: list[int | None] = [None, None]
    told.switch(enable=1, mask=0xFC, outputs=bits(numbers))
    register.feed(told.events())
    register.latched.clear()
    numbers[port - 1] = STYLES.index(style)
    for count in (150, -170, 33):
        told.begin()
        told.span({port - 1: count}, INTERVAL, outputs=bits(numbers))
        told.go(0.15)
    register.feed(told.events())
    shield = Shield(VirtualTime())
    motor, wanted = shield.motor(port), []
    for count, way in ((150, FORWARD), (170, BACKWARD), (33, FORWARD)):
        for _ in range(count):
            motor.onestep(way, style)
            wanted.append((shield.image, *duties(style, motor.position)))
    found = [(byte, register.duty(port, "A", at), register.duty(port, "B", at)) for at, byte in register.latched]
    assert found == wanted


def test_the_tables_of_two_phase_motion_are_those_of_the_shield(talk: Callable[[str], Any], register: Any):
    told = talk("uno-l293d")
    told.switch(enable=1, mask=0xFC, outputs=bits([None, None]))
    told.begin()
    told.span({0: 4}, INTERVAL, outputs=bits([1, None]), last=False)
    told.span({1: 4}, INTERVAL, outputs=bits([None, 1]))
    told.go(0.1)
    steps = [byte for byte in register.feed(told.events()).bytes if byte]
    assert steps == [0x06, 0x0A, 0x18, 0x14, 0x21, 0x81, 0xC0, 0x60]


def test_both_motors_at_once_keep_out_of_each_others_bits(talk: Callable[[str], Any], register: Any):
    told = talk("uno-l293d")
    told.switch(enable=1, mask=0xFC, outputs=bits([2, 3]))
    told.events()
    told.begin()
    told.span({0: 60, 1: -100}, INTERVAL, outputs=bits([2, 3]))
    assert told.go(0.1)["position"][:2].tolist() == [60, -100]
    last = register.feed(told.events()).bytes[-1]
    wanted = latch_byte(half_step().levels[60 % 8], 1, latch_byte(table_microstep().levels[-100 % 64], 2))
    assert last == wanted
    assert len(register.latched) <= 160


def test_drives_on_hold_and_off_are_open_and_empty(talk: Callable[[str], Any], register: Any):
    told = talk("uno-l293d")
    told.switch(enable=1, mask=0xFC, outputs=bits([2, 2]))
    assert register.feed(told.events()).bytes[-1] == 0x24  # both hold by phase A
    told.session.halt(drives_off=True)
    told.pass_on(0.01)
    assert register.feed(told.events()).bytes[-1] == 0
    control = told.line.chip.read_memory(0xB0, 1)[0], told.line.chip.read_memory(0x44, 1)[0]
    assert [value & 0xF0 for value in control] == [0, 0]  # TCCR2A, TCCR0A: no pin is a timer's
    assert told.line.chip.read_memory(0x2B, 1)[0] & 0x68 == 0  # and port D has them low
    assert told.line.chip.read_memory(0x25, 1)[0] & 0x08 == 0


def test_both_motors_at_the_greatest_rate_that_the_host_allows(talk: Callable[[str], Any], register: Any):
    told = talk("uno-l293d")
    told.switch(mask=0xFC, outputs=bits([3, 3]))
    told.switch(enable=1)
    told.events()
    told.begin()
    told.span({0: 400, 1: -399}, told.board.closest, outputs=bits([3, 3]))
    assert told.go(0.1)["position"][:2].tolist() == [400, -399]
    at = np.array([cycle for cycle, _ in register.feed(told.events()).latched])
    assert len(at) == 400  # both in one byte
    assert np.abs(np.diff(at) - told.board.closest).max() <= 320  # 20 us
    _, mean, worst = told.line.chip.interrupts()[11]
    assert mean < 450
    assert worst < 900


def test_a_step_that_lies_between_two_of_the_other_motors(talk: Callable[[str], Any], register: Any):
    told = talk("uno-l293d")
    told.switch(mask=0xFC, outputs=bits([1, 1]))
    told.switch(enable=1)
    told.events()
    told.begin()
    told.spans({0: (1600, 300), 1: (1700, 280)}, outputs=bits([1, 1]))
    assert told.go(0.1)["position"][:2].tolist() == [300, 280]
    slots = {1600 * (k + 1) // 128 for k in range(300)} | {1700 * (k + 1) // 128 for k in range(280)}
    wanted = [128 * slot for slot in sorted(slots)]  # steps of one slot are one byte
    at = np.array([cycle for cycle, _ in register.feed(told.events()).latched])
    assert len(at) == len(wanted)
    late = at - np.array(wanted)
    assert np.ptp(late) <= 600  # a step may wait for the other motor's
