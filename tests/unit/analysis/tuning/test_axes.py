"""Loops for axes: what they are held to, and what they are better than."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.tuning import Moves, Robustness, judge, loop_margins, optimise, shape
from trochia.analysis.tuning.classic import single_loop, ultimate
from trochia.analysis.tuning.margins import is_stable
from trochia.analysis.tuning.optimise import breach
from trochia.analysis.tuning.rules import ziegler_nichols_closed
from trochia.analysis.tuning.shaping import step_on_twin
from trochia.errors import ConfigError, LimitError
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, ServoPlant
from trochia.servo import Loop, Pid
from trochia.servo.sampled import closed_poles, plant_response

PERIOD = 5e-4
TWO = ServoPlant(
    amplifier=Amplifier(current=20.0), torque_constant=0.1, motor_inertia=1e-4, load_inertia=2e-4, stiffness=20.0,
    damping=4e-3, gap=2e-3, motor_friction=Friction(coulomb=0.005, viscous=2e-4),
    load_friction=Friction(coulomb=0.008, viscous=3e-4),
)  # fmt: skip
LAGGING = ServoPlant(amplifier=Amplifier(current=10.0, lag=5e-3), torque_constant=0.1, motor_inertia=1e-3,
                     motor_friction=Friction(viscous=1e-2), counts=50000.0)  # fmt: skip


def test_a_shaped_loop_keeps_its_margin_and_beats_ziegler_and_nichols() -> None:
    shaped = shape(TWO, PERIOD, limit=20.0)
    margins = loop_margins(TWO, shaped.loop)
    assert margins.stable
    assert margins.ms <= 1.7
    classic = single_loop(ziegler_nichols_closed(ultimate(TWO, PERIOD)), PERIOD, limit=20.0)
    assert shaped.step.settling < step_on_twin(TWO, classic, 0.1).settling


def test_the_search_keeps_the_bounds_and_is_no_worse_than_shaping() -> None:
    kept = Robustness(ms=1.6, gm=3.0, pm_deg=40.0)
    found = optimise(TWO, PERIOD, bounds=kept, limit=20.0, generations=3)
    margins = loop_margins(TWO, found.loop)
    assert margins.stable
    assert margins.ms <= 1.605
    assert margins.gm >= 2.95
    assert margins.pm_deg >= 39.5
    assert found.step.settling <= shape(TWO, PERIOD, limit=20.0).step.settling


def test_margins_that_no_loop_keeps_are_named() -> None:
    with pytest.raises(LimitError, match="no cascade keeps Ms below 1"):
        shape(TWO, PERIOD, most_ms=1.0001)


def test_feed_forward_makes_the_error_vanish_on_the_nominal_plant() -> None:
    nominal = ServoPlant(torque_constant=0.1, motor_inertia=3e-4, motor_friction=Friction(coulomb=0.01, viscous=5e-4))
    shaped = shape(nominal, PERIOD)
    plain = Loop(period=PERIOD, position=shaped.loop.position, speed=shaped.loop.speed)
    moves = Moves(way=2.0, time=0.4)
    assert judge(nominal, shaped.loop, moves).following.rms < judge(nominal, plain, moves).following.rms / 100.0


def test_unstable_gains_are_named_and_never_run() -> None:
    wild = Loop(period=PERIOD, position=Pid(kp=100.0), speed=Pid(kp=50.0))
    assert not is_stable(TWO, wild)
    with pytest.raises(ConfigError, match="gains: these gains are unstable"):
        judge(TWO, wild)


def test_at_the_gain_margin_a_pole_reaches_the_unit_circle() -> None:
    """Two ways that share nothing but the plant: frequency response, and eigenvalues."""
    loop = shape(TWO, PERIOD).loop
    assert loop.speed is not None
    gm = loop_margins(TWO, loop).gm
    for factor, outside in ((0.98 * gm, False), (1.02 * gm, True)):
        speed = replace(loop.speed, kp=factor * loop.speed.kp, ki=factor * loop.speed.ki)
        radius = np.abs(closed_poles(TWO, replace(loop, speed=speed))).max()
        assert bool(radius > 1.0) is outside


def test_the_breach_is_none_inside_the_bounds() -> None:
    f = np.geomspace(0.01, 500.0, 4000)
    whole = 20.0 / (2j * math.pi * f)  # an integrator: Ms 1, phase margin 90
    assert breach(whole, Robustness(ms=1.05, pm_deg=89.0)) == 0.0
    assert breach(whole, Robustness(ms=1.05, pm_deg=95.0)) > 0.0


def test_the_ultimate_gain_is_where_the_response_is_minus_one() -> None:
    found = ultimate(LAGGING, PERIOD)
    value = complex(plant_response(LAGGING, np.array([1.0 / found.time]), PERIOD)[0])
    assert found.gain * value == pytest.approx(-1.0, abs=1e-6)
