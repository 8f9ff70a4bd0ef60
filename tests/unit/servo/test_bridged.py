"""The leadscrew's bridge: its table of truth, the brake, over-run in closed form and on the twin, moves with slip."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from trochia.errors import ConfigError, LimitError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, Power, ServoPlant
from trochia.machine.servos.bridge import Driven, driven, over_run
from trochia.servo.bridged import BridgedMotor

#: the machine's motor: 24 V, an L298 that takes 2 V, 30 slots before the gear
MOTOR = ServoPlant(
    amplifier=Amplifier(mode=Mode.VOLTAGE, voltage=24.0, drop=2.0, current=4.0), resistance=5.5, inductance=2e-3,
    torque_constant=0.0393, emf_constant=0.0393, motor_inertia=4.73e-6, counts=30.0 / math.tau,
    motor_friction=Friction(viscous=7e-5, coulomb=2e-3),
)  # fmt: skip


@pytest.mark.parametrize(
    ("enable", "a", "b", "expected"),
    [
        (True, False, True, Driven(Power.DRIVEN, -1)),
        (True, True, False, Driven(Power.DRIVEN, 1)),
        (True, False, False, Driven(Power.BRAKED, 0)),
        (True, True, True, Driven(Power.BRAKED, 0)),
        (False, False, False, Driven(Power.FREE, 0)),
        (False, True, False, Driven(Power.FREE, 0)),
    ],
)
def test_the_table_of_truth(*, enable: bool, a: bool, b: bool, expected: Driven) -> None:
    assert driven(enable=enable, a=a, b=b) == expected


def running(plant: ServoPlant, *, duty: float = 1.0) -> BridgedMotor:
    """Return a motor at the speed of a duty."""
    motor = BridgedMotor(plant)
    motor.pins(enable=True, a=True, b=False)
    motor.run(duty, 4000)
    return motor


@pytest.mark.parametrize("power", [Power.FREE, Power.BRAKED])
@pytest.mark.parametrize("duty", [1.0, 600 / 1023])
def test_the_twin_runs_on_as_the_closed_form_says(power: Power, duty: float) -> None:
    """Its ways and times by speed, with friction dry and viscous and the bridge's drop."""
    plant = replace(MOTOR, inductance=2e-6, counts=1e4)  # the closed form leaves the winding's L/R out
    motor = running(plant, duty=duty)
    speed, before = motor.speed, motor.pulses
    expected = over_run(plant, speed, power)
    motor.pins(enable=power is Power.BRAKED, a=True, b=True)
    motor.run(0.0, 8000)
    assert abs(motor.speed) < 1e-3 * speed
    assert (motor.pulses - before) / 1e4 == pytest.approx(expected.way, rel=0.01)
    assert expected.time < 8000 * 128e-6


def test_the_brake_shortens_the_way_by_the_ratio_of_its_lag() -> None:
    """Without dry friction and drop the way is speed · lag: J / b free, J / (b + Kt Kb / R) braked."""
    plain = replace(MOTOR, amplifier=replace(MOTOR.amplifier, drop=0.0), motor_friction=Friction(viscous=7e-5))
    free, braked = (over_run(plain, 400.0, power) for power in (Power.FREE, Power.BRAKED))
    assert free.way == pytest.approx(400.0 * 4.73e-6 / 7e-5)
    assert braked.way == pytest.approx(400.0 * 4.73e-6 / (7e-5 + 0.0393**2 / 5.5))
    assert over_run(plain, 200.0, Power.BRAKED).way == pytest.approx(0.5 * braked.way)
    # the full speed of the machine, coasting with its bridge at zero: 28.8 pulses
    assert braked.way * 30.0 / math.tau * 447.5 / 400.0 == pytest.approx(28.8, rel=0.03)


def test_dry_friction_alone_and_nothing_at_all() -> None:
    dry = replace(MOTOR, motor_friction=Friction(coulomb=2e-3))
    assert over_run(dry, 100.0, Power.FREE).way == pytest.approx(4.73e-6 * 100.0**2 / (2 * 2e-3))
    with pytest.raises(LimitError, match="nothing stops"):
        over_run(replace(MOTOR, motor_friction=Friction()), 100.0, Power.FREE)


def test_a_braked_motor_is_let_go_after_half_a_second() -> None:
    motor = running(MOTOR)
    assert motor.power is Power.DRIVEN
    came = motor.brake()
    assert motor.power is Power.FREE
    assert abs(motor.speed) < 1e-2
    assert 0 < came < 60


def test_a_move_slips_by_what_the_brake_takes_at_the_slow_duty() -> None:
    motor = BridgedMotor(MOTOR)
    moved = motor.move(3000)
    slow = running(MOTOR, duty=600 / 1023).speed
    expected = over_run(MOTOR, slow, Power.BRAKED).way * 30.0 / math.tau
    assert moved.slip == pytest.approx(expected, abs=2.0)
    assert moved.pulses == 3000 + moved.slip
    assert motor.power is Power.FREE
    back = motor.move(3000 + moved.slip, way=-1)
    assert back.slip == pytest.approx(moved.slip, abs=1.0)


def test_what_does_not_come_there_is_named_and_off() -> None:
    motor = BridgedMotor(replace(MOTOR, motor_friction=Friction(coulomb=2.0, smooth=1.0)))  # it only creeps
    with pytest.raises(LimitError, match=r"of 100 pulses came in 0\.5 s; the motor is off"):
        motor.move(100, most_time=0.5)
    assert motor.power is Power.FREE
    with pytest.raises(ConfigError, match="at least 1"):
        motor.move(0)
    with pytest.raises(ConfigError, match="by voltage"):
        BridgedMotor(ServoPlant(motor_inertia=1.0))
