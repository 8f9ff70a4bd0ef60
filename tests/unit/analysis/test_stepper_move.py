"""A move judged by its motor: mechanics by hand, closed forms, and the twin that must agree."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from trochia.analysis.stepper_move import easier, move_use, torque_curve
from trochia.analysis.stepper_proof import prove_move
from trochia.errors import LimitError
from trochia.machine.drivers import Chopper, HBridge, fed
from trochia.machine.motors import ShaftLoad, motor
from trochia.machine.torque import Drive
from trochia.pulses.ramps import Demand, profile

STEPPER = motor("QSH5718-55").parameters()
LOAD = ShaftLoad(inertia=300e-7, constant=0.1, friction=0.05)
MADE = fed(STEPPER, Chopper(supply=24.0, current=2.8), 16)
SHAFT = Drive(made=MADE, load=LOAD, per_radian=1.0, margin=0.3)
TURN = 3200
ANGLE = math.tau / TURN
MOVE = Demand(steps=4 * TURN, steps_per_turn=TURN, speed=300 / 60 * TURN, acceleration=500 / ANGLE)


def test_torque_of_each_part_by_hand():
    use = move_use(profile(MOVE), SHAFT)
    inertia = 209e-7 + 300e-7
    middle = 2 * TURN
    assert use.needed[50] == pytest.approx(inertia * 500 + 0.1, rel=1e-3)
    assert use.needed[middle] == pytest.approx(0.1)
    assert use.needed[-50] == pytest.approx(-inertia * 500 + 0.1, rel=1e-3)  # the load helps it to brake
    there = MADE.pull_out(np.array(300 / 60 * math.tau), LOAD)
    assert use.available[middle] == pytest.approx(float(there))
    assert use.left == pytest.approx(1 - (inertia * 500 + 0.1) / float(there), rel=0.01)
    assert use.easy
    assert use.start_stop * ANGLE == pytest.approx(MADE.start_stop(LOAD))
    assert use.resonance == pytest.approx(16 * math.sqrt(50 * MADE.holding / inertia) / math.tau)


def test_the_first_step_that_is_lost_is_where_the_curve_is_crossed():
    """The torque falls beyond the corner speed: an even acceleration is lost where pull-out equals J a + load."""
    wanted = float(MADE.pull_out(np.array(100.0), LOAD))
    rate = (wanted - LOAD.constant) / SHAFT.inertia
    made = profile(replace(MOVE, speed=160 / ANGLE, acceleration=rate / ANGLE))
    lost = move_use(made, SHAFT).lost_at
    assert lost is not None
    assert made.speeds[lost] * ANGLE == pytest.approx(100.0, rel=0.02)


def test_jumps_of_speed_shorter_than_a_swing_are_not_blamed():
    smooth = move_use(profile(MOVE), SHAFT)
    jumping = move_use(profile(MOVE, "linear"), SHAFT)
    assert jumping.left == pytest.approx(smooth.left, abs=0.03)


def test_a_start_too_fast():
    made = profile(replace(MOVE, steps=40, speed=600 / 60 * TURN, acceleration=5e9))
    assert not move_use(made, SHAFT).starts
    held = Drive(made=MADE, load=replace(LOAD, constant=2.0), per_radian=1.0, margin=0.3)
    assert move_use(profile(MOVE), held).start_stop == 0.0
    with pytest.raises(LimitError, match="holds the motor"):
        torque_curve(held, TURN)


def test_the_law_made_for_torque_uses_all_but_the_margin():
    curve, load = torque_curve(SHAFT, TURN)
    asked = replace(MOVE, speed=900 / 60 * TURN, acceleration=None, curve=curve, load=load, inertia=SHAFT.inertia)
    made = profile(asked, "torque")
    use = move_use(made, SHAFT)
    reached = int(np.argmax(made.speeds > 0.99 * made.peak))
    assert use.used[60 : reached - 60] == pytest.approx(0.7, abs=0.01)
    assert use.easy


@pytest.mark.parametrize("speed", [300.0, 900.0, 6000.0])
def test_what_would_do_does(speed: float):
    asked = profile(replace(MOVE, speed=speed / 60 * TURN, acceleration=50_000 / ANGLE))
    assert not move_use(asked, SHAFT).ok
    found = easier(asked, SHAFT)
    assert found is not None
    assert found.demand.speed <= asked.demand.speed
    assert found.demand.rising <= asked.demand.rising
    assert move_use(found, SHAFT).easy
    assert easier(found, SHAFT).delays == pytest.approx(found.delays)  # type: ignore[union-attr]


def test_the_twin_agrees_where_the_motor_is_damped():
    damped = ShaftLoad(inertia=300e-7, friction=0.05, viscous=2e-3)
    shaft = Drive(made=MADE, load=damped, per_radian=1.0, margin=0.3)
    easy = profile(replace(MOVE, acceleration=2000 / ANGLE))
    assert move_use(easy, shaft).easy
    assert prove_move(easy, MADE, damped).ok
    steep = profile(replace(MOVE, acceleration=30_000 / ANGLE))
    use, proof = move_use(steep, shaft), prove_move(steep, MADE, damped)
    assert use.lost_at is not None
    assert not proof.ok
    assert proof.lost % 4 == 0
    assert proof.step is not None


def test_hunting_is_told_and_a_lower_speed_is_found():
    """A voltage drive without damping falls out of step above some speed, though its torque would suffice."""
    made = fed(motor("SM-42BYG011-25").parameters(), HBridge(supply=12.0), 1)
    load = ShaftLoad(inertia=100e-7, friction=0.004)
    shaft = Drive(made=made, load=load, per_radian=1.0, margin=0.3)
    asked = profile(Demand(steps=400, speed=2000.0, acceleration=15_900.0))
    use = move_use(asked, shaft)
    assert use.ok
    assert use.hunts is not None
    proof = prove_move(asked, made, load)
    assert not proof.ok
    assert proof.steady(asked)
    assert proof.steady(asked) is not replace(proof, step=5).steady(asked)
    assert easier(asked, shaft, slower=True).demand.speed <= 0.8 * asked.demand.speed  # type: ignore[union-attr]
    found = easier(asked, shaft, lambda one: prove_move(one, made, load).ok)
    assert found is not None
    assert found.demand.speed < use.hunts
    assert prove_move(found, made, load).ok
