"""The card's law in whole numbers against its formula, its integral; feed-forward by inverse dynamics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trochia.kernels.servo_law import pmac_bits
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import Amplifier, Mode, ServoPlant
from trochia.machine.servos import PmacLoop
from trochia.servo.axis import Loop, ServoAxis
from trochia.servo.forward import feed_forward
from trochia.servo.pid import Pid
from trochia.servo.scaling import PmacGains

#: the gains of the xy-table's first motor
GAINS = {"i30": 22521, "i31": 11280, "i08": 96, "i09": 96, "i64": 0, "i65": 0, "i63": 1 << 22, "i67": 1 << 22,
         "i69": 20480}  # fmt: skip


def bits(commanded, actual, **gains):
    rows = [32 * np.asarray(values, np.int64) for values in (commanded, actual)]
    return pmac_bits(GAINS | gains, *rows).tolist()


@given(
    way=st.lists(st.tuples(st.integers(-3000, 3000), st.integers(-3000, 3000)), min_size=1, max_size=30),
    i32=st.integers(0, 20000),
    i35=st.integers(0, 90000),
)
def test_the_law_is_its_formula(way, i32, i35):
    """In whole counts and exact fractions, cycle by cycle; a bit is lost where the division is cut."""
    commanded, actual = (np.array(column) for column in zip(*way, strict=True))
    gains = PmacGains(i30=22521, i31=11280, i32=i32, i35=i35)
    cv = np.diff(commanded, prepend=commanded[0])
    ca, av = np.diff(cv, prepend=0), np.diff(actual, prepend=actual[0])
    expected = [
        gains.output(int(c - a), int(v), int(k), int(w), 0)
        for c, a, v, k, w in zip(commanded, actual, cv, ca, av, strict=True)
    ]
    assert bits(commanded, actual, i32=i32, i35=i35) == expected


def test_one_count_and_saturation():
    """4.1237 bits a count: the limit of 20480 bits, 6.25 V, is reached at 4967 counts; 2000 counts are 2.517 V."""
    assert bits([1000], [0]) == [4123]
    assert bits([4966], [0])[0] < 20480
    assert bits([4967], [0]) == [20480]
    assert bits([2000], [0])[0] * 10 / 32768 == pytest.approx(2.517, abs=1e-3)


def test_the_dead_band_takes_itself_off():
    """i65 = 16 is a count: nothing up to it, and one count less beyond; i64 = 16 makes it none."""
    assert bits([1, 1], [0, 0], i65=16) == [0, 0]
    assert bits([11], [0], i65=16) == bits([10], [0])
    assert bits([-11], [0], i65=16) == bits([-10], [0])
    assert bits([11], [0], i65=16, i64=16) == bits([11], [0])


def test_the_integral_waits_for_rest_and_stops_at_its_limits():
    still = bits([100] * 200, [0] * 200, i33=1 << 20, i34=1)
    assert still[-1] > still[0]
    moving = bits(range(100, 300), range(200), i33=1 << 20, i34=1, i31=0)
    assert len(set(moving)) == 1
    free = bits(range(100, 300), range(200), i33=1 << 20, i34=0, i31=0)
    assert free[-1] > free[0]
    bound = bits([100] * 200, [0] * 200, i33=1 << 20, i34=1, i63=1000)
    assert bound[-1] == bound[20]
    # pushed into the limit it does not wind up: the error turned, the output leaves the limit at once
    pushed = bits([6000] * 100 + [-100], [0] * 101, i33=1 << 16, i34=0, i31=0)
    assert pushed[99] == 20480
    assert pushed[100] < 0


LOOPS = {
    "pid": Loop(period=5e-4, position=Pid(kp=30.0, kd=0.6, c=0.0)),
    "cascade": Loop(period=5e-4, position=Pid(kp=50.0), speed=Pid(kp=0.6, ki=20.0)),
    "averaged": Loop(period=5e-4, position=Pid(kp=50.0), speed=Pid(kp=0.6, ki=20.0), averaged=4),
}


@pytest.mark.parametrize("name", LOOPS)
def test_what_a_late_speed_makes_of_acceleration_is_taken_off(name):
    """A parabolic move of a rigid plant: a ten-thousandth of it is left, where the push alone would leave ten times."""
    plant = ServoPlant(torque_constant=0.1, motor_inertia=3e-4, motor_friction=Friction(viscous=5e-4))
    loop = feed_forward(plant, LOOPS[name])
    u = np.arange(801) / 800
    wanted = np.stack([2 * u * u * (3 - 2 * u), 30 * u * (1 - u), 75 * (1 - 2 * u)], axis=1)
    error = np.abs(wanted[:, 0] - ServoAxis(plant, loop).run(wanted).motor).max()
    late = 0.5 * loop.period * loop.averaged
    push = loop.position.kd if loop.speed is None else loop.speed.kp
    with_push = replace(loop, acceleration_forward=loop.acceleration_forward + 2 * push * late)
    assert error < 1e-4
    assert np.abs(wanted[:, 0] - ServoAxis(plant, with_push).run(wanted).motor).max() > 10 * error


@pytest.mark.parametrize("mode", [Mode.CURRENT, Mode.VOLTAGE])
@pytest.mark.parametrize("cascade", [True, False])
def test_feed_forward_leaves_next_to_nothing_on_the_nominal_plant(mode, cascade):
    plant = ServoPlant(
        amplifier=Amplifier(mode=mode, gain=2.0), resistance=1.5, inductance=1e-3, torque_constant=0.1,
        emf_constant=0.1, motor_inertia=2e-4, load=0.05,
        motor_friction=Friction(coulomb=0.08, viscous=5e-4, smooth=0.5),
    )  # fmt: skip
    if cascade:
        loop = Loop(period=0.5e-3, position=Pid(kp=60), speed=Pid(kp=0.3))
    else:
        loop = Loop(period=0.5e-3, position=Pid(kp=20, kd=0.3, c=0.0))
    t = loop.period * np.arange(4000)
    w = 2 * np.pi * 1.0
    wanted = 20 * np.stack([1 - np.cos(w * t), w * np.sin(w * t), w * w * np.cos(w * t)], axis=1)
    errors = [
        (wanted[:, 0] - ServoAxis(plant, kind).run(wanted).motor)[1000:] for kind in (loop, feed_forward(plant, loop))
    ]
    plain, fed = (float(np.sqrt(np.mean(e**2))) for e in errors)
    assert fed < plain / 250


def test_a_file_cannot_ask_for_what_overflows():
    with pytest.raises(Exception, match="i30"):
        PmacLoop(i30=1 << 24)
