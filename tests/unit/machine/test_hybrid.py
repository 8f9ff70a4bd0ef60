"""The hybrid stepper's equations against the laws they must keep."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.machine.motors import HybridStepper, ShaftLoad, motor

MOTOR = HybridStepper(teeth=50, resistance=0.8, inductance=2.1e-3, current=3.0, inertia=209e-7, torque_constant=0.231,
                      detent=0.02, friction=0.004, viscous=1e-4)  # fmt: skip
BARE = motor("QSH5718-55").parameters()

angles = st.floats(-10, 10)
speeds = st.floats(-300, 300)
currents = st.tuples(st.floats(-4, 4), st.floats(-4, 4)).map(np.array)


@given(angles, speeds, currents)
def test_electrical_power_is_mechanical_power(theta: float, omega: float, i: np.ndarray):
    electrical = float(MOTOR.back_emf(np.array(theta), np.array(omega)) @ i)
    magnetic = float(MOTOR.torque(i, np.array(theta)) - MOTOR.detent_torque(np.array(theta)))
    assert electrical == pytest.approx(magnetic * omega, abs=1e-9)


@given(angles)
def test_torque_is_the_slope_of_detent_energy(theta: float):
    def energy(x: float) -> float:
        return -MOTOR.detent / (4 * MOTOR.teeth) * math.cos(4 * MOTOR.teeth * x)

    step = 1e-6
    slope = (energy(theta + step) - energy(theta - step)) / (2 * step)
    assert float(MOTOR.detent_torque(np.array(theta))) == pytest.approx(-slope, abs=1e-7)


def test_back_emf_at_constant_speed_has_two_phases_a_quarter_apart():
    omega, time = 20.0, np.linspace(0, 0.1, 1001)
    e = BARE.back_emf(omega * time, np.full_like(time, omega))
    np.testing.assert_allclose(np.hypot(*e.T), BARE.torque_constant * omega, rtol=1e-12)
    quarter = math.pi / 2 / (BARE.teeth * omega)
    earlier = BARE.back_emf(omega * (time - quarter), np.full_like(time, omega))
    np.testing.assert_allclose(e[:, 1], earlier[:, 0], atol=1e-9)


@pytest.mark.parametrize(("i", "rest"), [((1, 0), 0), ((0, 1), 90), ((-1, 0), 180), ((0, -1), 270), ((1, 1), 45)])
def test_current_holds_where_the_excitation_says(i: tuple[int, int], rest: float):
    theta = math.radians(rest) / BARE.teeth + np.array([-1e-4, 0.0, 1e-4])
    torque = BARE.torque(np.tile(np.array(i, float), (3, 1)), theta)
    assert torque[0] > 0 > torque[2]
    assert torque[1] == pytest.approx(0.0, abs=1e-12)


def test_derivative_at_standstill_is_ohm_and_newton():
    state = np.array([1.0, -0.5, 0.0, 0.0])
    rate = MOTOR.derivative(state, np.array([5.0, 2.0]), ShaftLoad(inertia=MOTOR.inertia, constant=0.05))
    expected = [(5 - 0.8) / 2.1e-3, (2 + 0.4) / 2.1e-3, 0.0, (0.231 * -0.5 - 0.05) / (2 * MOTOR.inertia)]
    np.testing.assert_allclose(rate, expected, rtol=1e-12)


def test_derivative_takes_many_states_at_once():
    states = np.random.default_rng(5).normal(size=(3, 7, 4))
    volts = np.random.default_rng(6).normal(size=(3, 7, 2))
    together = MOTOR.derivative(states, volts)
    np.testing.assert_array_equal(together[1, 2], MOTOR.derivative(states[1, 2], volts[1, 2]))


@given(speeds)
def test_friction_only_takes_power(omega: float):
    state = np.array([0.0, 0.0, 0.0, omega])
    at_rest = MOTOR.derivative(np.zeros(4), np.zeros(2))[3]
    slowing = MOTOR.derivative(state, np.zeros(2), ShaftLoad(friction=0.1, viscous=0.01))[3] - at_rest
    assert slowing * omega <= 0
    assert abs(slowing) * MOTOR.inertia <= 0.104 + 0.0101 * abs(omega) + 1e-12


def test_lost_steps_are_whole_turns_of_the_field_less_the_lag():
    theta, still = np.zeros(5), np.zeros(5)
    field = math.tau * np.array([0.0, 0.49, 0.51, 1.0, -2.0])
    assert MOTOR.lost_steps(field, theta, still).tolist() == [0, 0, 4, 4, -8]
    fast = np.full(1, 400.0)  # currents lag by 89 degrees there: 200 degrees of load angle is in step
    assert MOTOR.lost_steps(np.radians([200.0]), np.zeros(1), fast).tolist() == [0]
    assert MOTOR.lost_steps(np.radians([280.0]), np.zeros(1), fast).tolist() == [4]
