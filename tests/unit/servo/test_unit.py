"""An amplifier as a unit: the first jog turns the motor, protections stop it, and ready and alarm tell."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from trochia.errors import ConfigError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, Power, ServoPlant
from trochia.machine.servos.panel import Key
from trochia.servo.unit import AmplifierUnit

INERTIA, KT = 7e-5, 0.332
OWN = math.tau * 100.0 * INERTIA / KT
PLANT = ServoPlant(
    amplifier=Amplifier(mode=Mode.SPEED, gain=52.4, current=11.5, speed_gain=OWN,
                        speed_integral=OWN * math.tau * 25.0),
    torque_constant=KT, emf_constant=0.2213, resistance=1.2, inductance=4e-3, motor_inertia=INERTIA,
    motor_friction=Friction(coulomb=0.02, viscous=2e-4, smooth=0.05), counts=8192 / math.tau,
)  # fmt: skip
JOG = 20.0 * math.tau


def jogging() -> AmplifierUnit:
    """Return one brought to JOG by its keys, the motor energised."""
    unit = AmplifierUnit(PLANT, jog=JOG)
    unit.supply(on=True)
    unit.advance(5.0)
    assert unit.panel.ready(unit.now)
    assert unit.panel.display == "PSoF"
    unit.press(Key.MODE)
    unit.press(Key.ENTER)
    unit.advance(1.0)
    unit.release(Key.ENTER)
    unit.press(Key.ENTER)
    unit.release(Key.ENTER)
    unit.advance(0.1)
    assert (unit.panel.display, unit.power) == ("_JOG", Power.DRIVEN)
    return unit


@pytest.mark.parametrize(("key", "way"), [(Key.UP, 1), (Key.DOWN, -1)])
def test_the_first_jog_turns_the_motor_by_its_ramp(key: Key, way: int) -> None:
    unit = jogging()
    unit.press(key)
    unit.advance(0.15)
    assert unit.speed == pytest.approx(0.5 * way * JOG, rel=0.05)  # half of the ramp
    unit.advance(0.35)
    assert unit.speed == pytest.approx(way * JOG, rel=0.01)
    unit.release(key)
    unit.advance(0.5)
    assert abs(unit.speed) < 0.5
    assert way * unit.position == pytest.approx(JOG * 0.5, rel=0.05)  # two ramps of 0.3 s and 0.2 s between


def test_before_it_is_ready_neither_keys_nor_run_move_it() -> None:
    unit = AmplifierUnit(PLANT, jog=JOG)
    unit.supply(on=True)
    unit.command = 1.0
    unit.run(on=True)
    unit.press(Key.UP)
    unit.advance(1.0)
    assert (unit.ready, unit.power, unit.position) == (False, Power.FREE, 0.0)


def test_the_controller_s_command_is_a_speed() -> None:
    unit = AmplifierUnit(PLANT, jog=JOG)
    unit.supply(on=True)
    unit.advance(5.0)
    unit.command = 2.0
    unit.run(on=True)
    unit.advance(1.0)
    assert unit.speed == pytest.approx(104.8, rel=0.01)
    unit.run(on=False)
    unit.advance(0.01)
    assert unit.power is Power.FREE


def test_a_jammed_screw_trips_on_current_and_stays_off_until_reset() -> None:
    unit = jogging()
    unit.press(Key.UP)
    unit.advance(0.4)
    unit.jam()
    unit.advance(0.15)
    assert unit.current > 11.0
    assert unit.healthy
    unit.advance(0.3)
    assert (unit.healthy, unit.ready, unit.power, unit.current) == (False, False, Power.FREE, 0.0)
    assert unit.panel.display == "oL"
    unit.press(Key.UP)
    unit.advance(0.1)
    assert unit.power is Power.FREE
    unit.reset()
    assert unit.ready
    unit.advance(0.1)
    assert unit.power is Power.FREE  # what was energised is not energised again by itself


def test_a_lost_supply_stops_the_motor_then_takes_the_drive() -> None:
    unit = jogging()
    unit.press(Key.UP)
    unit.advance(0.5)
    unit.supply(on=False)
    unit.advance(2e-3)
    assert unit.power is Power.BRAKED
    assert not unit.ready
    unit.advance(8.0 * 2.0 * 4e-3 / 1.2)  # shorted, winding and rotor swing and die out with 2 L / R
    assert abs(unit.speed) < 0.02 * JOG
    unit.advance(1.0)
    assert unit.power is Power.FREE


def test_a_panel_needs_an_amplifier_of_speed() -> None:
    with pytest.raises(ConfigError, match="must be speed"):
        AmplifierUnit(replace(PLANT, amplifier=Amplifier()), jog=JOG)
