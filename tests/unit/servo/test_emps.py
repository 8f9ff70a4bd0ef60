"""A prismatic servo axis with published parameters: EMPS (Janot, Gautier, Brunot 2019).

The recorded machine tracked its program with 0.5764 mm RMS and about 0.85 mm at most; inverse dynamics as feed-forward
made the error of the model 275 times smaller.  The program here is our own, of the same kind: three moves out and
three back, dwells between, a lap of 6.24 s.
"""

from __future__ import annotations

import numpy as np
import pytest

from trochia.analysis.identification import inverse_dynamics
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant
from trochia.servo import Loop, Pid, ServoAxis

PERIOD, LAP, ACCELERATION = 1e-3, 6.24, 0.8333
FORCE, MASS, VISCOUS, COULOMB, OFFSET = 35.1507, 95.1089, 203.5034, 20.3935, -3.1648
PLANT = ServoPlant(
    amplifier=Amplifier(gain=1.0), torque_constant=FORCE, motor_inertia=MASS, counts=1 / 50e-9,
    motor_friction=Friction(coulomb=COULOMB, viscous=VISCOUS, offset=OFFSET),
)  # fmt: skip
POSITION, SPEED = Pid(kp=160.18), Pid(kp=243.45)


def lap() -> np.ndarray:
    """Return set-points (ticks, 3) of one lap [m, m/s, m/s²]."""
    moves = [
        (ramp, cruise, sign) for sign in (1, -1) for ramp, cruise in ((0.050, 0.351), (0.098, 0.687), (0.148, 1.035))
    ]
    dwell = (LAP - sum(2 * ramp + cruise for ramp, cruise, _ in moves)) / len(moves) / 2
    parts = [(0.0, 0.0)]
    for ramp, cruise, sign in moves:
        a = sign * ACCELERATION
        parts += [(dwell, 0.0), (ramp, a), (cruise, 0.0), (ramp, -a), (dwell, 0.0)]
    t = PERIOD * np.arange(round(LAP / PERIOD))
    wanted, start, x, v = np.zeros((len(t), 3)), 0.0, 0.0, 0.0
    for duration, a in parts:
        inside = (t >= start - 1e-12) & (t < start + duration)
        tau = t[inside] - start
        wanted[inside] = np.stack([x + tau * (v + 0.5 * a * tau), v + a * tau, np.full(len(tau), a)], axis=1)
        x, v, start = x + duration * (v + 0.5 * a * duration), v + a * duration, start + duration
    return wanted


def error_of(loop: Loop) -> np.ndarray:
    """Return the tracking error of the second lap [m]."""
    wanted = np.tile(lap(), (2, 1))
    samples = ServoAxis(PLANT, loop).run(wanted)
    return (wanted[:, 0] - samples.measured)[len(wanted) // 2 :]


@pytest.fixture(scope="module")
def plain() -> np.ndarray:
    return error_of(Loop(period=PERIOD, position=POSITION, speed=SPEED, limit=10.0))


def test_the_axis_tracks_as_the_recorded_machine_did(plain: np.ndarray) -> None:
    assert 0.56e-3 <= np.sqrt(np.mean(plain**2)) <= 0.58e-3
    assert 0.83e-3 <= np.abs(plain).max() <= 0.86e-3


def test_inverse_dynamics_as_feed_forward_leaves_less_than_a_250th(plain: np.ndarray) -> None:
    forward = error_of(Loop(
        period=PERIOD, position=POSITION, speed=SPEED, limit=10.0, speed_forward=1.0,
        acceleration_forward=MASS / FORCE, viscous_forward=VISCOUS / FORCE, friction_forward=COULOMB / FORCE,
        bias=OFFSET / FORCE,
    ))  # fmt: skip
    assert np.sqrt(np.mean(plain**2)) / np.sqrt(np.mean(forward**2)) > 250


def test_least_squares_finds_mass_and_friction_again() -> None:
    wanted = np.tile(lap(), (2, 1))
    samples = ServoAxis(PLANT, Loop(period=PERIOD, position=POSITION, speed=SPEED, limit=10.0)).run(wanted)
    found = inverse_dynamics(samples.measured, samples.command * FORCE, PERIOD, rotary=False)
    assert found["mass"] == pytest.approx(MASS, rel=0.005)
    assert found["viscous"] == pytest.approx(VISCOUS, rel=0.02)
    assert found["coulomb"] == pytest.approx(COULOMB, rel=0.02)
    assert found["offset"] == pytest.approx(OFFSET, rel=0.02)
