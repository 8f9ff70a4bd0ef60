"""The servo axis in C against its equations in Python, closed forms, and its controllers in Python."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy import integrate, signal

from trochia.errors import LimitError
from trochia.kernels.servo import ServoKernel
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, ServoPlant
from trochia.servo import Loop, Pid, PidController, Sampling, ServoAxis, Windup
from trochia.servo.axis import plant_members

DC = ServoPlant(
    amplifier=Amplifier(mode=Mode.VOLTAGE, voltage=24.0), resistance=5.5, inductance=2e-3, torque_constant=0.0393,
    emf_constant=0.0393, motor_inertia=4.73e-6, motor_friction=Friction(viscous=7e-5),
)  # fmt: skip
TWO = ServoPlant(
    torque_constant=0.1, motor_inertia=1e-4, load_inertia=3e-4, stiffness=20.0, damping=2e-3,
    motor_friction=Friction(viscous=1e-4), load_friction=Friction(viscous=2e-4),
)  # fmt: skip
RUBBING = ServoPlant(
    torque_constant=0.1, motor_inertia=1e-4, load_inertia=3e-4, stiffness=20.0, damping=2e-3, gap=0.02,
    motor_friction=Friction(coulomb=0.01, stick=0.015, stribeck=2.0, viscous=1e-4, smooth=0.05),
    load_friction=Friction(coulomb=0.004, viscous=2e-4, offset=0.002, smooth=0.05), load=0.003,
)  # fmt: skip


def driven(plant: ServoPlant, command: float, seconds: float, h: float = 1e-5) -> np.ndarray:
    """Return motor and load positions each millisecond."""
    steps = round(1e-3 / h)
    out = ServoKernel(plant_members(plant, h)).drive(np.full(round(seconds * 1000) + 1, command), steps=steps)
    return np.stack([out.motor, out.load, out.current], axis=1)


@pytest.mark.parametrize(("plant", "command"), [(DC, 22.0), (TWO, 0.5), (RUBBING, 0.6)], ids=["dc", "two", "rubbing"])
def test_the_plant_follows_its_equations(plant: ServoPlant, command: float) -> None:
    times = np.arange(301) * 1e-3
    exact = integrate.solve_ivp(
        lambda _, y: plant.derivative(y, command), (0.0, 0.3), np.zeros(5), "Radau", times, rtol=1e-9, atol=1e-12
    ).y
    got = driven(plant, command, 0.3)
    scale = np.abs(exact[0]).max()
    np.testing.assert_allclose(got[:, 0], exact[0], atol=2e-4 * scale)
    np.testing.assert_allclose(got[:, 1], exact[1], atol=2e-4 * scale)


def test_a_half_as_long_step_leaves_a_quarter_of_the_error() -> None:
    exact = driven(TWO, 0.5, 0.2, h=1e-6)[-1, 0]
    errors = [abs(driven(TWO, 0.5, 0.2, h=h)[-1, 0] - exact) for h in (1e-4, 5e-5)]
    assert 3.0 < errors[0] / errors[1] < 5.0


def test_a_dc_motor_runs_up_as_its_transfer_function_says() -> None:
    """Against an exact discretisation of Kt / ((L s + R)(J s + b) + Kt Kb) / s."""
    gains = DC.linear()
    times = np.arange(201) * 1e-3
    _, exact = signal.step((gains.numerator, gains.denominator), T=times)
    np.testing.assert_allclose(driven(DC, 22.0, 0.2)[:, 0], 22.0 * exact, rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("of_load", [False, True])
def test_the_linear_part_of_two_masses_is_their_transfer_function(*, of_load: bool) -> None:
    gains = TWO.linear(of_load=of_load)
    times = np.arange(301) * 1e-3
    _, exact = signal.step((gains.numerator, gains.denominator), T=times)
    np.testing.assert_allclose(driven(TWO, 0.5, 0.3)[:, int(of_load)], 0.5 * exact, rtol=1e-3, atol=1e-5)
    poles = np.sort(np.abs(np.roots(gains.denominator).imag))
    inertia = TWO.motor_inertia * TWO.load_inertia / (TWO.motor_inertia + TWO.load_inertia)
    assert poles[-1] == pytest.approx(math.sqrt(20.0 / inertia), rel=2e-3)  # sqrt(k (1/Jm + 1/Jl))


def test_a_steady_speed_balances_torque_and_friction() -> None:
    plant = ServoPlant(torque_constant=2.0, motor_inertia=0.01,
                       motor_friction=Friction(coulomb=0.5, viscous=0.1, offset=-0.2), load=0.3)  # fmt: skip
    out = ServoKernel(plant_members(plant, 1e-5)).drive(np.full(2000, 1.5), steps=100)
    assert out.speed[-1] == pytest.approx((2.0 * 1.5 - 0.5 + 0.2 - 0.3) / 0.1, rel=1e-6)


def test_the_bridge_takes_its_drop_and_no_more_than_there_is() -> None:
    bridge = Amplifier(mode=Mode.VOLTAGE, voltage=24.0, drop=2.0)
    plant = ServoPlant(amplifier=bridge, resistance=5.5, inductance=2e-3, torque_constant=0.0393,
                       emf_constant=0.0393, motor_inertia=4.73e-6, motor_friction=Friction(viscous=7e-5))  # fmt: skip
    np.testing.assert_allclose(driven(plant, 24.0, 0.5)[-1], driven(DC, 22.0, 0.5)[-1], rtol=1e-9)
    assert driven(plant, 1.5, 0.1)[-1, 0] == 0.0


def test_pwm_has_steps_and_a_limit() -> None:
    pwm = Amplifier(mode=Mode.VOLTAGE, voltage=22.0, levels=1023)
    plant = ServoPlant(amplifier=pwm, resistance=1.0, torque_constant=1.0, motor_inertia=1e9)
    out = ServoKernel(plant_members(plant, 1e-5)).drive(np.array([0.0, 0.010, 0.011, 30.0, 0.0]), steps=1)
    np.testing.assert_allclose(out.current[1:], [0.0, 0.0, 22.0 / 1023, 22.0], atol=1e-12)


def test_the_current_has_its_limit_and_lag() -> None:
    plant = ServoPlant(amplifier=Amplifier(gain=2.0, current=3.0, lag=1e-3), torque_constant=1.0, motor_inertia=1e9)
    out = ServoKernel(plant_members(plant, 1e-5)).drive(np.full(101, 1.0), steps=10)
    np.testing.assert_allclose(out.current, 2.0 * (1.0 - np.exp(-np.arange(101) * 0.1)), atol=1e-9)
    out = ServoKernel(plant_members(plant, 1e-5)).drive(np.full(101, 9.0), steps=10)
    assert out.current.max() == 3.0


PIDS = [
    Pid(kp=3.0, ki=40.0, kd=0.02, filter=300.0, sampling=sampling, windup=windup, limit=limit, sum_limit=0.3,
        track=0.02, b=b, c=c, incremental=incremental)
    for sampling, windup, limit, (b, c), incremental in itertools.product(
        Sampling, Windup, (math.inf, 0.8), ((1.0, 1.0), (0.7, 0.0)), (False, True)
    )
]  # fmt: skip


@pytest.mark.parametrize(
    "pid", PIDS, ids=lambda p: f"{p.sampling.value}-{p.windup.name}-{p.limit}-{p.b}-{p.incremental}"
)
def test_a_controller_in_c_says_what_it_says_in_python(pid: Pid) -> None:
    axis = ServoAxis(TWO, Loop(period=1e-3, position=pid))
    rng = np.random.default_rng(5)
    wanted = np.zeros((400, 3))
    wanted[:, 0] = np.cumsum(rng.normal(0.0, 0.02, 400)) + 0.3
    samples = axis.run(wanted)
    controller = PidController(pid, 1e-3)
    for r, y, u in zip(wanted[:, 0], samples.measured, samples.command, strict=True):
        assert controller.compute_output(r, y) == pytest.approx(u, abs=1e-9)
        controller.update(r, y, controller.compute_output(r, y))


@pytest.mark.parametrize("sampling", list(Sampling))
def test_positional_and_incremental_forms_agree_where_nothing_limits(sampling: Sampling) -> None:
    commands = [
        ServoAxis(TWO, Loop(period=1e-3, position=Pid(kp=3.0, ki=40.0, kd=0.02, filter=300.0, sampling=sampling,
                                                      incremental=incremental))).run(np.full((500, 3), 0.1)).command
        for incremental in (False, True)
    ]  # fmt: skip
    np.testing.assert_allclose(commands[0], commands[1], atol=1e-9)


def test_any_cut_into_blocks_gives_the_same_samples() -> None:
    loop = Loop(period=1e-3, position=Pid(kp=20.0), speed=Pid(kp=0.05, ki=0.5), averaged=3)
    wanted = np.linspace(0.0, 1.0, 900)[:, None] * [1.0, 0.0, 0.0]
    whole = ServoAxis(RUBBING, loop).run(wanted)
    axis = ServoAxis(RUBBING, loop)
    parts = [axis.run(part) for part in np.split(wanted, [1, 7, 300, 301])]
    np.testing.assert_array_equal(whole.measured, np.concatenate([part.measured for part in parts]))
    np.testing.assert_array_equal(whole.command, np.concatenate([part.command for part in parts]))


def test_a_loop_that_runs_away_is_named() -> None:
    axis = ServoAxis(TWO, Loop(period=1e-3, position=Pid(kp=-1e6)))
    with pytest.raises(LimitError, match="run away"):
        axis.run(np.full((5000, 3), 1.0))


def test_an_encoder_counts_whole_counts_and_noise_of_speed_is_theirs() -> None:
    plant = ServoPlant(torque_constant=1.0, motor_inertia=1.0, counts=1000.0)
    samples = ServoAxis(plant, Loop(period=1e-3, bias=1.0)).run(np.zeros((2000, 3)))
    np.testing.assert_array_equal(samples.measured, np.floor(samples.motor * 1000.0) / 1000.0)
    np.testing.assert_allclose(samples.speed * 1e-3 * 1000.0, np.round(samples.speed * 1e-3 * 1000.0), atol=1e-6)
