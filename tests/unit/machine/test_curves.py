"""Closed forms of torque against the steady state solved angle by angle, and against their limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.errors import LimitError
from trochia.machine.motors import HybridStepper, ShaftLoad, library, motor
from trochia.machine.motors.curves import corner_speed, holding_torque, pull_out_torque, start_stop_speed
from trochia.pulses.excitation import EXCITATIONS, microstep

MOTORS = {name: row.parameters() for name, row in library().items()}


def greatest_steady_torque(stepper: HybridStepper, omega: float, voltage: float) -> float:
    """Solve d and q voltages for the currents at every load angle, and take the best torque."""
    angle = np.linspace(0, 2 * np.pi, 20001)
    x = stepper.teeth * omega * stepper.inductance
    v_d, v_q = -voltage * np.sin(angle), voltage * np.cos(angle)
    #  v_d = R i_d - x i_q,  v_q = R i_q + x i_d + K w
    matrix = np.array([[stepper.resistance, -x], [x, stepper.resistance]])
    _, i_q = np.linalg.solve(matrix, np.stack([v_d, v_q - stepper.torque_constant * omega]))
    return float((stepper.torque_constant * i_q).max())


@pytest.mark.parametrize("name", MOTORS)
@pytest.mark.parametrize("full_steps", [1, 100, 700, 4000])
def test_pull_out_is_the_best_load_angle(name: str, full_steps: float):
    stepper = MOTORS[name]
    omega = stepper.speed(full_steps)
    expected = greatest_steady_torque(stepper, omega, 24.0)
    assert float(pull_out_torque(stepper, np.array(omega), 24.0)) == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_pull_out_at_rest_is_ohms_law_and_current_control_caps_it():
    stepper = MOTORS["QSH5718-55"]
    still = np.zeros(1)
    assert pull_out_torque(stepper, still, 2.4)[0] == pytest.approx(stepper.torque_constant * 2.4 / 0.8)
    assert pull_out_torque(stepper, still, 24.0, current=3.0)[0] == pytest.approx(stepper.torque_constant * 3.0)


@given(st.floats(0, 300))
def test_frictions_are_taken_off_and_direction_does_not_matter(omega: float):
    stepper = MOTORS["QSH5718-79"]
    both = pull_out_torque(stepper, np.array([omega, -omega]), 48.0, load=ShaftLoad(viscous=1e-3, friction=0.02))
    assert both[0] == both[1]
    free = float(pull_out_torque(stepper, np.array(omega), 48.0))
    assert both[0] == pytest.approx(free - 1e-3 * omega - 0.02)


def test_holding_torque_by_mode():
    row = motor("SM-42BYG011-25")
    stepper = row.parameters()
    assert holding_torque(stepper, EXCITATIONS["two-phase"]) == pytest.approx(row.holding_torque)
    assert holding_torque(stepper, EXCITATIONS["one-phase"]) == pytest.approx(row.holding_torque / math.sqrt(2))
    assert holding_torque(stepper, microstep(16), current=0.1) == pytest.approx(stepper.torque_constant * 0.1)


@given(st.floats(1.01, 150), st.sampled_from(list(MOTORS)))
def test_corner_speed_uses_up_the_supply(times: float, name: str):
    stepper = MOTORS[name]
    voltage = times * stepper.resistance * stepper.current
    omega = corner_speed(stepper, voltage)
    resistive = stepper.resistance * stepper.current + stepper.torque_constant * omega
    inductive = stepper.teeth * omega * stepper.inductance * stepper.current
    assert math.hypot(resistive, inductive) == pytest.approx(voltage, rel=1e-9)


def test_corner_speed_needs_more_than_the_resistive_drop():
    with pytest.raises(LimitError, match=r"takes more than 2\.4 V"):
        corner_speed(MOTORS["QSH5718-55"], 2.0)


def test_unloaded_start_in_fine_steps_is_the_pendulum_s_escape():
    """A pendulum at its lowest point gets over the top with 2 sqrt(T/(p J))."""
    stepper = MOTORS["QSH5718-55"]
    fastest = start_stop_speed(stepper, 0.98, step_angle=0.0)
    assert fastest == pytest.approx(2 * math.sqrt(0.98 / (stepper.teeth * stepper.inertia)))


def test_start_is_harder_with_load_inertia_and_coarse_steps():
    stepper = MOTORS["QSH5718-55"]
    free = start_stop_speed(stepper, 0.98)
    assert start_stop_speed(stepper, 0.98, load=ShaftLoad(inertia=3 * stepper.inertia)) == pytest.approx(free / 2)
    assert start_stop_speed(stepper, 0.98, load=ShaftLoad(constant=0.3)) < free
    assert start_stop_speed(stepper, 0.98, step_angle=math.pi / 4) > free


def test_a_load_that_cannot_start_is_refused():
    stepper = MOTORS["QSH5718-55"]
    with pytest.raises(LimitError, match="cannot be turned"):
        start_stop_speed(stepper, 0.98, load=ShaftLoad(constant=0.99))
    # two neighbouring torque curves cross at 0.707 of the torque: above, one whole step is too much
    assert start_stop_speed(stepper, 0.98, load=ShaftLoad(constant=0.69)) > 0
    with pytest.raises(LimitError, match="does not take the first step"):
        start_stop_speed(stepper, 0.98, load=ShaftLoad(constant=0.70))


@pytest.mark.parametrize("full_steps", [100, 900, 1500, 4000, 9000])
def test_current_and_voltage_limits_together_are_the_best_point_of_both_discs(full_steps: float):
    """Every current within I, every voltage it needs within V: the best of a fine grid is the closed form."""
    stepper = MOTORS["QSH5718-55"]
    omega, volts, amps = stepper.speed(full_steps), 24.0, 3.0
    i_d, i_q = np.meshgrid(np.linspace(-amps, amps, 1501), np.linspace(-amps, amps, 1501))
    x = stepper.teeth * omega * stepper.inductance
    v_d = stepper.resistance * i_d - x * i_q
    v_q = stepper.resistance * i_q + x * i_d + stepper.torque_constant * omega
    allowed = (np.hypot(i_d, i_q) <= amps) & (np.hypot(v_d, v_q) <= volts)
    best = stepper.torque_constant * float(i_q[allowed].max())
    found = float(pull_out_torque(stepper, np.array(omega), volts, current=amps))
    assert found == pytest.approx(best, abs=stepper.torque_constant * 0.01)


@pytest.mark.parametrize(("volts", "amps"), [(12.0, 0.6), (24.0, 1.0), (48.0, 3.0)])
def test_torque_falls_with_speed_and_beyond_a_current_that_back_emf_exceeds_there_is_none(volts: float, amps: float):
    """Where all currents that the voltage allows are above the one that is set, the motor does not run."""
    stepper = MOTORS["QSH5718-79"]
    speed = np.linspace(0.0, 2000.0, 4001)
    torque = pull_out_torque(stepper, speed, volts, current=amps)
    runs = torque > 0
    assert (np.diff(torque[runs]) <= 1e-9).all()
    assert not (~runs[:-1] & runs[1:]).any()
    least = (stepper.torque_constant * speed - volts) / np.abs(stepper.impedance(speed))  # flows whatever is set [A]
    assert (torque[least > amps] < 0).all()
    assert (least[-1] > amps) == (torque[-1] < 0)
