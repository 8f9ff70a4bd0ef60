"""What an amplifier does with a winding: its own speed loop, a short, an open circuit; against their equations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate, signal

from trochia.kernels.servo import ServoKernel
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, Power, ServoPlant
from trochia.servo.axis import Loop, ServoAxis, plant_members
from trochia.servo.forward import feed_forward
from trochia.servo.pid import Pid
from trochia.servo.sampled import closed_poles, plant_response

OWN = math.tau * 60.0 * 4e-4 / 0.1
SPEED = ServoPlant(
    amplifier=Amplifier(mode=Mode.SPEED, gain=30.0, lag=5e-4, speed_gain=OWN, speed_integral=OWN * math.tau * 15.0),
    torque_constant=0.1, motor_inertia=4e-4, motor_friction=Friction(viscous=1e-3),
)  # fmt: skip
SPLIT = replace(SPEED, motor_inertia=1e-4, load_inertia=3e-4, stiffness=40.0, damping=5e-3)
DC = ServoPlant(
    amplifier=Amplifier(mode=Mode.VOLTAGE, voltage=24.0), resistance=5.5, inductance=2e-3, torque_constant=0.0393,
    emf_constant=0.0393, motor_inertia=4.73e-6, motor_friction=Friction(viscous=7e-5),
)  # fmt: skip


def driven(plant: ServoPlant, command: float, seconds: float) -> np.ndarray:
    """Return the motor's position each millisecond."""
    kernel = ServoKernel(plant_members(plant, 1e-5))
    return kernel.drive(np.full(round(seconds * 1000) + 1, command), steps=100).motor


@pytest.mark.parametrize("plant", [SPEED, SPLIT, replace(SPEED, load=0.02)], ids=["one", "two", "loaded"])
def test_a_speed_amplifier_follows_its_equations(plant: ServoPlant) -> None:
    times = np.arange(201) * 1e-3
    exact = integrate.solve_ivp(
        lambda _, y: plant.derivative(y, 2.0), (0.0, 0.2), np.zeros(6), "Radau", times, rtol=1e-9, atol=1e-12
    ).y
    np.testing.assert_allclose(driven(plant, 2.0, 0.2), exact[0], atol=5e-4 * np.abs(exact[0]).max())


@pytest.mark.parametrize("plant", [SPEED, SPLIT, replace(SPEED, amplifier=replace(SPEED.amplifier, lag=0.0))])
def test_its_transfer_function_and_its_sampled_states_agree(plant: ServoPlant) -> None:
    gains = plant.linear()
    times = np.arange(201) * 1e-3
    _, exact = signal.step((gains.numerator, gains.denominator), T=times)
    np.testing.assert_allclose(driven(plant, 2.0, 0.2), 2.0 * exact, rtol=2e-3, atol=1e-4)
    frequency = np.geomspace(0.5, 20.0, 30)
    s = 2j * np.pi * frequency
    continuous = np.polyval(gains.numerator, s) / np.polyval(gains.denominator, s)
    held = plant_response(plant, frequency, 1e-5) / np.exp(-s * 0.5e-5)  # half a tick of holding
    np.testing.assert_allclose(held, continuous, rtol=1e-3)


def test_ten_volts_are_its_speed_whatever_the_load_and_current_has_its_limit() -> None:
    limited = replace(SPEED, amplifier=replace(SPEED.amplifier, current=5.0), load=0.05)
    kernel = ServoKernel(plant_members(limited, 1e-5))
    rows = kernel.drive(np.full(2000, 10.0), steps=100)
    assert rows.speed[-1] == pytest.approx(300.0, rel=1e-4)
    assert rows.current.max() == pytest.approx(5.0)
    # limited, it runs up by Kt i less friction and load; its integral did not wind up meanwhile
    assert rows.speed[100] == pytest.approx((0.5 - 0.05) / 1e-3 * -np.expm1(-0.1 * 1e-3 / 4e-4), rel=0.01)
    assert rows.speed.max() < 1.1 * 300.0


def test_an_offset_of_the_command_is_a_speed() -> None:
    kernel = ServoKernel(plant_members(replace(SPEED, amplifier=replace(SPEED.amplifier, offset=0.05)), 1e-5))
    assert kernel.drive(np.zeros(1000), steps=100).speed[-1] == pytest.approx(1.5, rel=1e-4)


def test_a_position_loop_around_it_follows_with_the_feed_forward_of_its_gain() -> None:
    loop = feed_forward(SPEED, Loop(period=1e-3, position=Pid(kp=1.0)))
    assert np.abs(closed_poles(SPEED, loop)).max() < 1.0
    t = 1e-3 * np.arange(1500)
    wanted = np.stack([50.0 * t, np.full(1500, 50.0), np.zeros(1500)], axis=1)
    lag = wanted[:, 0] - ServoAxis(SPEED, loop).run(wanted).measured
    plain = wanted[:, 0] - ServoAxis(SPEED, Loop(period=1e-3, position=Pid(kp=1.0))).run(wanted).measured
    assert plain[-1] == pytest.approx(50.0 / 30.0, rel=1e-3)  # v / (kp · gain)
    assert abs(lag[-1]) < 1e-3 * plain[-1]


@pytest.mark.parametrize("mode", [Mode.VOLTAGE, Mode.CURRENT])
def test_a_shorted_winding_brakes_and_an_open_one_does_not(mode: Mode) -> None:
    """The one with R J / (R b + Kt Kb), the other with J / b, whatever the amplifier did before."""
    plant = replace(DC, inductance=1e-6, amplifier=Amplifier(mode=mode, voltage=24.0))
    for power, lag in ((Power.BRAKED, 5.5 * 4.73e-6 / (5.5 * 7e-5 + 0.0393**2)), (Power.FREE, 4.73e-6 / 7e-5)):
        kernel = ServoKernel(plant_members(plant, 1e-5))
        kernel.drive(np.full(20, 5.0 if mode is Mode.VOLTAGE else 0.1), steps=100)
        kernel.set_plant(plant_members(plant, 1e-5, power))
        speed = kernel.drive(np.full(21, 24.0), steps=100).speed
        assert speed[1] > 0.0
        assert speed[11] / speed[1] == pytest.approx(math.exp(-10e-3 / lag), rel=0.01)
        assert kernel.drive(np.full(2, 24.0), steps=1).current[0] <= 0.0
