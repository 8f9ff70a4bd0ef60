"""Variable reluctance dynamics: energy, closed forms, and steps in the right direction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trochia.errors import ConfigError
from trochia.machine.motors import ReluctanceStepper, ShaftLoad
from trochia.machine.motors.reluctance_drive import ReluctanceDrive

GEOMETRIES = [
    ReluctanceStepper(poles=8, teeth=6),
    ReluctanceStepper(poles=12, teeth=14),
    ReluctanceStepper(poles=6, teeth=4),
]


def drive_of(geometry: ReluctanceStepper) -> ReluctanceDrive:
    return ReluctanceDrive(
        geometry=geometry, resistance=2.0, aligned=12e-3, unaligned=4e-3, inertia=5e-6, viscous=8e-4, friction=1e-3
    )


def test_torque_is_the_slope_of_the_co_energy():
    motor = drive_of(GEOMETRIES[0])
    currents, theta = np.array([1.2, 0.3, 0.0, 0.7]), np.array(0.11)

    def energy(x: float) -> float:
        return float(0.5 * (currents**2 * motor.inductance(np.array(x))).sum())

    slope = (energy(0.11 + 1e-6) - energy(0.11 - 1e-6)) / 2e-6
    assert float(motor.torque(currents, theta)) == pytest.approx(slope, rel=1e-6)


def test_holding_torque_is_the_greatest_over_a_tooth():
    motor = drive_of(GEOMETRIES[1])
    angle = np.linspace(0, math.tau / 14, 2001)
    currents = np.zeros((2001, motor.geometry.phases))
    currents[:, 0] = 1.5
    assert motor.torque(currents, angle).max() == pytest.approx(motor.holding_torque(1.5), rel=1e-5)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_turn_of_excitation_moves_one_tooth_pitch_its_own_way(geometry: ReluctanceStepper):
    motor = drive_of(geometry)
    per_step, step = 800, 50e-6
    phase = np.repeat(np.arange(geometry.phases + 1), per_step)
    run = motor.run(phase, 6.0, step=step)
    at = run[per_step - 1 :: per_step, -2]
    expected = geometry.direction * math.radians(float(geometry.step_angle_deg)) * np.arange(geometry.phases + 1)
    assert at == pytest.approx(expected, abs=0.1 * abs(expected[1]))
    assert run[:, : geometry.phases].min() >= 0.0


def test_a_load_above_the_holding_torque_is_not_held():
    motor = drive_of(GEOMETRIES[0])
    hold = motor.holding_torque(3.0)  # 6 V over 2 ohm
    phase = np.zeros(2000)
    held = motor.run(phase, 6.0, step=50e-6, load=ShaftLoad(constant=0.5 * hold))[-1, -2]
    lost = motor.run(phase, 6.0, step=50e-6, load=ShaftLoad(constant=1.2 * hold))[-1, -2]
    pitch = math.tau / 6
    assert held == pytest.approx(-math.asin(0.5) / 6, rel=0.05)
    assert lost < -pitch


def test_absurd_values_are_named():
    with pytest.raises(ConfigError, match="out of line"):
        ReluctanceDrive(geometry=GEOMETRIES[0], resistance=2.0, aligned=4e-3, unaligned=12e-3, inertia=5e-6)
    with pytest.raises(ConfigError, match="above zero"):
        ReluctanceDrive(geometry=GEOMETRIES[0], resistance=0.0, aligned=12e-3, unaligned=4e-3, inertia=5e-6)
