"""The motor shield's names, its register's bytes, its delays."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.errors import ConfigError, LimitError
from trochia.stepper import (
    BACKWARD,
    DOUBLE,
    FORWARD,
    INTERLEAVE,
    MICROSTEP,
    SINGLE,
    Calls,
    Kept,
    Shield,
    ShieldMotor,
    Stepper,
    Style,
    VirtualTime,
)

ONE, TWO = (
    {1: [0x04, 0x02, 0x08, 0x10], 2: [0x20, 0x01, 0x80, 0x40]},
    {
        1: [0x06, 0x0A, 0x18, 0x14],
        2: [0x21, 0x81, 0xC0, 0x60],
    },
)
HALF = {port: [byte for pair in zip(ONE[port], TWO[port], strict=True) for byte in pair] for port in (1, 2)}


def made(port: int = 1, rpm: float = 60, *, whole: bool = False) -> tuple[ShieldMotor, Kept]:
    kept = Kept()
    motor = Shield(VirtualTime()).motor(port, 200, kept, whole_milliseconds=whole)
    motor.set_speed(rpm)
    return motor, kept


@pytest.mark.parametrize("port", [1, 2])
@pytest.mark.parametrize(
    ("style", "turn"), [(SINGLE, ONE), (DOUBLE, TWO), (INTERLEAVE, HALF)], ids=["single", "double", "interleave"]
)
def test_bytes_of_a_turn(port: int, style: Style, turn: dict[int, list[int]]):
    motor, _ = made(port)
    motor.step(1, BACKWARD, style)  # from where it stands, to the last of a turn
    motor.step(len(turn[port]), FORWARD, style)
    seen = [byte for _, byte in motor.shield.latched]
    assert seen[1:] == turn[port]
    motor.shield.latched.clear()
    motor.step(len(turn[port]), BACKWARD, style)
    assert [byte for _, byte in motor.shield.latched] == [*turn[port][-2::-1], turn[port][-1]]


def test_another_excitation_falls_in_with_half_a_step():
    motor, _ = made()
    motor.step(1, FORWARD, SINGLE)
    motor.step(1, FORWARD, DOUBLE)
    motor.step(1, FORWARD, SINGLE)
    assert [byte for _, byte in motor.shield.latched] == [0x02, 0x0A, 0x08]


def test_a_motor_leaves_the_other_ones_bits():
    shield = Shield(VirtualTime())
    one, two = shield.motor(1), shield.motor(2)
    two.onestep(FORWARD, DOUBLE)
    one.onestep(FORWARD, SINGLE)
    assert shield.image == 0x21 | 0x02
    two.release()
    assert shield.image == 0x02


def test_microsteps_go_round_a_circle():
    motor, kept = made()
    levels = []
    for _ in range(64):
        motor.onestep(FORWARD, MICROSTEP)
        levels.append(motor.levels)
    assert np.hypot(*np.array(levels).T) == pytest.approx(1, abs=0.004)
    assert motor.position == 0
    kept.moments.clear()
    motor.step(3, FORWARD, MICROSTEP)
    assert len(kept.moments) == 48
    assert np.diff(kept.moments) == pytest.approx(0.005 / 16)


def test_interleave_covers_half_the_way_in_half_the_time():
    motor, kept = made(rpm=20)
    motor.step(100, FORWARD, INTERLEAVE)
    assert motor.shield.time.now == pytest.approx(100 * 0.015 / 2)
    assert len(kept.moments) == 100


@pytest.mark.parametrize(("rpm", "gaps"), [(150, {2}), (200, {1, 2}), (20, {15}), (190, {1, 2})])
def test_whole_milliseconds_carry_the_rest(rpm: float, gaps: set[int]):
    motor, kept = made(rpm=rpm, whole=True)
    motor.step(1000, FORWARD, DOUBLE)
    milliseconds = np.diff(kept.moments) * 1000
    assert milliseconds == pytest.approx(np.rint(milliseconds), abs=1e-6)
    assert set(np.rint(milliseconds)) == gaps
    assert motor.shield.time.now == pytest.approx(60 / (200 * rpm) * 1000, abs=0.002)


def test_swapped_functions_reverse_the_sense():
    motor, kept = made(2)
    swapped = Calls(lambda: motor.onestep(BACKWARD, SINGLE), lambda: motor.onestep(FORWARD, SINGLE))
    stepper = Stepper(swapped, motor.shield.time)
    stepper.set_max_speed(150)
    stepper.set_acceleration(300)
    stepper.run_to_new_position(10)
    stepper.disable_outputs()
    assert kept.directions == [-1] * 10
    stepper.run_to_new_position(9)
    assert kept.directions[-1] == 1


def test_what_the_shield_has_not_is_refused():
    shield = Shield(VirtualTime())
    with pytest.raises(ConfigError, match="ports 1 and 2"):
        shield.motor(3)
    motor = shield.motor(1)
    with pytest.raises(LimitError, match="set_speed"):
        motor.step(1)
    with pytest.raises(LimitError, match="more than 0 rpm"):
        motor.set_speed(0)
    motor.set_speed(60)
    for count in (-3, 2.5, "x"):
        with pytest.raises(LimitError, match="count"):
            motor.step(count)  # type: ignore[arg-type]
    for direction in (0, 2, "forward"):
        with pytest.raises(LimitError, match="FORWARD"):
            motor.step(1, direction)  # type: ignore[arg-type]
    for call in (motor.step, lambda _count, *rest: motor.onestep(*rest)):
        with pytest.raises(LimitError, match="INTERLEAVE"):
            call(1, FORWARD, "DOUBLE")  # type: ignore[arg-type]
    assert motor.shield.time.now == 0
