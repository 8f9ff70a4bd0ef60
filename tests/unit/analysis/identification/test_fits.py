"""Models found again in data made from them, within the uncertainty that is stated."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.identification import fit_step, inverse_dynamics
from trochia.analysis.identification.step import delayed, first_order, second_order
from trochia.errors import RecordingError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import ServoPlant
from trochia.servo import Loop, Pid, ServoAxis

T = np.linspace(0.0, 1.0, 1000)


@pytest.mark.parametrize(
    ("model", "response", "truth"),
    [
        ("first-order", first_order(T, 3.0, 0.08), {"gain": 1.5, "lag": 0.08}),
        ("fopdt", delayed(T, 3.0, 0.08, 0.05), {"gain": 1.5, "lag": 0.08, "dead": 0.05}),
        ("second-order", second_order(T, 3.0, 40.0, 0.3), {"gain": 1.5, "frequency": 40.0, "damping": 0.3}),
        ("second-order", second_order(T, 3.0, 40.0, 1.6), {"gain": 1.5, "frequency": 40.0, "damping": 1.6}),
    ],
)
def test_a_step_s_model_is_found_again(model: str, response: np.ndarray, truth: dict[str, float]) -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.02, len(T))
    found = fit_step(T, response + noise, step=2.0, model=model)
    for name, value in truth.items():
        assert abs(found[name] - value) < 4 * found.numbers[name].sigma, name
        assert found.numbers[name].sigma < 0.05 * value
    assert found.rms == pytest.approx(0.02, rel=0.1)
    assert found.fit > 0.99


@pytest.mark.parametrize(
    ("t", "y", "why"),
    [
        (T[:5], T[:5], "at least 8 samples"),
        (T, np.zeros(1000), "does not move"),
        (T[::-1], T, "rising times"),
        (T, np.full(1000, np.nan), "finite"),
    ],
)
def test_data_that_shows_no_step_is_refused(t: np.ndarray, y: np.ndarray, why: str) -> None:
    with pytest.raises(RecordingError, match=why):
        fit_step(t, y)


def test_mass_and_friction_of_a_measured_motion() -> None:
    """A rotary axis under its loop; the published tolerance of the method is 0.5 % of inertia and 2 % of friction."""
    plant = ServoPlant(torque_constant=0.5, motor_inertia=2e-3, counts=8192 / (2 * np.pi),
                       motor_friction=Friction(coulomb=0.05, viscous=0.004, offset=0.01))  # fmt: skip
    t = np.arange(8000) * 1e-3
    x = 20.0 * np.sin(2 * np.pi * 0.8 * t) ** 3
    wanted = np.stack([x, np.gradient(x, 1e-3), np.zeros(len(t))], axis=1)
    samples = ServoAxis(plant, Loop(period=1e-3, position=Pid(kp=60.0), speed=Pid(kp=0.1, ki=1.0))).run(wanted)
    found = inverse_dynamics(samples.measured, samples.command * 0.5, 1e-3, cutoff=40.0)
    assert found["inertia"] == pytest.approx(2e-3, rel=0.005)
    assert found["viscous"] == pytest.approx(0.004, rel=0.02)
    assert found["coulomb"] == pytest.approx(0.05, rel=0.02)
    assert found["offset"] == pytest.approx(0.01, abs=0.02 * 0.05)  # of the level of friction


def test_motion_that_does_not_excite_is_refused() -> None:
    t = np.arange(1000) * 1e-3
    with pytest.raises(RecordingError, match="both ways"):
        inverse_dynamics(np.exp(t) - t, np.ones(1000), 1e-3)
    with pytest.raises(RecordingError, match="at least 100"):
        inverse_dynamics(t[:10], t[:10], 1e-3)
