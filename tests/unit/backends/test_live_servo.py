"""Servo joints of the live twin: lag by closed form, settling, cuts into blocks, rejoining, the trip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia.backends.live_servo import LiveServo
from trochia.backends.plant import Plant
from trochia.machine.load import load
from trochia.machine.servos.drive import servo_drive

TICK = 442e-6


def table(**loop):
    made = load("xy-table")
    return replace(made, joints=tuple(replace(j, loop=replace(j.loop, **loop)) for j in made.joints))


def servo(machine):
    drive = servo_drive(machine, 0)
    assert drive is not None
    return LiveServo(machine.joints[0], drive, position=5.0, tick=TICK)


def ramp(speed, seconds):
    t = TICK * np.arange(1, round(seconds / TICK))
    return 5.0 + speed * (t - 0.1 * np.tanh(t / 0.1))


def test_lag_without_feed_forward_is_the_derivative_time():
    one = servo(table(i32=0, i35=0))
    one.follow(ramp(6.0, 1.0))
    one.follow(one._past[-1] + 6.0 * TICK * np.arange(1, 500))
    assert one.lag == pytest.approx(6.0 * 11280 * TICK / 128, rel=0.1)  # 39 ms; friction adds to it


def test_cuts_into_blocks_change_nothing():
    way = ramp(10.0, 0.4)
    whole, cut = servo(table()), servo(table())
    at = whole.follow(way)[1]
    pieces = np.concatenate([cut.follow(piece)[1] for piece in np.array_split(way, 37)])
    np.testing.assert_allclose(pieces, at, atol=1e-12)
    assert whole.measured == cut.measured


def test_a_loop_of_another_period_sees_the_command_in_between():
    lathe = load("lathe")
    drive = servo_drive(lathe, 1)
    assert drive is not None
    one = LiveServo(lathe.joints[1], drive, position=0.0, tick=lathe.servo_period)
    t = lathe.servo_period * np.arange(1, 2000)
    one.follow(-3.0 * (t - 0.1 * np.tanh(t / 0.1)))
    assert one.lag < 0.06
    assert one.restless


def test_it_comes_to_rest_where_it_is_told():
    one = servo(table())
    way = ramp(10.0, 0.3)
    one.follow(way)
    assert one.restless
    one.follow(np.full(round(0.6 / TICK), way[-1]))
    assert not one.restless
    # dry friction holds it off by at most what its gain overcomes: 30 N and 0.02 N·m against 1.64 V/rad
    friction = 0.02 + 30 * 2e-3 / (2 * np.pi)
    volts = friction / (0.332 * 1.15)
    assert abs(one.measured - way[-1]) < 2 / (2 * np.pi) * volts / 1.6408 + 2 / 4096


def test_rejoining_forgets_the_error():
    plant = Plant(table(), np.zeros(2))
    plant.follow(np.tile([0.2, 0.0], (40, 1)))
    assert 0 < plant.motor[0] < 0.25
    true = plant.rejoin(np.array([0.2, 0.0]))
    assert true[0] == plant.motor[0]
    plant.follow(np.tile(true, (200, 1)))
    assert plant.motor[0] == pytest.approx(true[0], abs=1e-3)


def test_the_greatest_lag_on_the_way_counts():
    """A jump of 1 mm is caught though the block ends where it has been made good."""
    plant = Plant(table(), np.zeros(2))
    plant.follow(np.tile([1.0, 0.0], (4000, 1)))
    assert plant.lag[0] == pytest.approx(1.0, abs=0.01)
    assert abs(plant.motor[0] - 1.0) < 0.05


def test_a_jammed_axis_lags_by_its_command():
    plant = Plant(table(), np.zeros(2))
    plant.jammed.add("X")
    plant.follow(np.tile([0.7, 0.0], (10, 1)))
    assert plant.lag[0] == pytest.approx(0.7)
    assert plant.load[0] == 0
