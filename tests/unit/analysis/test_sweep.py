"""Sweeps on the twin against closed forms, and the timing of pulses against its rule."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from trochia import api
from trochia.analysis.sweep import (
    TIMINGS,
    curve,
    operating_points,
    pull_in_torque,
    pull_out_speed,
    pull_out_torque_measured,
    start_stop_speed_measured,
)
from trochia.analysis.sweep.picture import picture
from trochia.machine.drivers import Chopper, HBridge, fed
from trochia.machine.load import loads
from trochia.machine.motors import ShaftLoad, motor
from trochia.machine.torque import drive

RPM = math.pi / 30
SHIELD = fed(motor("SM-42BYG011-25").parameters(), HBridge(supply=12.0))
STAGE = (Path(__file__).parents[2] / "golden" / "machines" / "stage.toml").read_text(encoding="utf-8")


def test_whole_milliseconds_carry_the_rest():
    """At 200 steps a turn 150 rpm are 2 ms, even; at 200 rpm 1 and 2 ms take turns; the mean is right."""
    even, mixed = (TIMINGS["millisecond"].times(60 / 200 / rpm, 200) for rpm in (150, 200))
    assert np.diff(even) == pytest.approx(2e-3)
    assert sorted({round(1e3 * d, 6) for d in np.diff(mixed)}) == [1.0, 2.0]
    assert mixed[-1] == pytest.approx(200 * 1.5e-3, abs=1e-3)
    assert TIMINGS["exact"].times(1.5e-3, 3) == pytest.approx([0, 1.5e-3, 3e-3, 4.5e-3])


def test_measured_pull_out_is_the_closed_form_where_the_motor_is_stable():
    """Fine steps and a current controller below its corner: K I, less half the ripple of the current."""
    made = fed(motor("QSH5718-55").parameters(), Chopper(supply=24.0, current=2.0, decay="slow"), 16)
    load = ShaftLoad(inertia=3e-5, friction=0.02, viscous=2e-3)
    for rpm in (60, 200):
        expected = float(made.pull_out(np.array(rpm * RPM), load))
        assert pull_out_torque_measured(made, rpm * RPM, load, repeats=1) == pytest.approx(expected, rel=0.02)


def test_pull_in_lies_below_pull_out_and_start_stop_below_pull_out_speed():
    load = ShaftLoad(friction=0.004)
    speed = 120 * RPM
    assert pull_in_torque(SHIELD, speed, load) < float(SHIELD.pull_out(np.array(speed), load))
    speeds = (np.arange(150.0, 300.0, 5.0) * RPM).tolist()
    pull_out = pull_out_speed(SHIELD, speeds, load)
    assert 250 * RPM < pull_out <= 300 * RPM
    heavy = ShaftLoad(inertia=2e-5, friction=0.004)
    light, slow = (start_stop_speed_measured(SHIELD, speeds, one) for one in (load, heavy))
    assert slow < light <= pull_out


def test_a_curve_tells_what_limits_it():
    made = curve(SHIELD, ShaftLoad(friction=0.004), points=8)
    assert made.pull_out == pytest.approx(SHIELD.pull_out(made.speeds))
    assert made.measured is None
    assert made.resonance == pytest.approx(math.sqrt(50 * SHIELD.holding / 38e-7) / math.tau)
    figures = made.figures()
    assert figures["curve"][0]["speed_steps_s"] == pytest.approx(figures["curve"][0]["speed_rpm"] * 200 / 60)
    bands = made.unstable()
    assert all(made.growth[(made.speeds >= low) & (made.speeds <= high)].min() > 0 for low, high in bands)
    assert picture(made, "shield").startswith(b"\x89PNG")
    assert picture(made, "shield", form="svg").lstrip().startswith(b"<?xml")


def test_points_of_a_program_lie_where_its_moves_are():
    machine = loads(STAGE)
    plan = api.check(b"G21 G90 G94\nG0 X100\nG0 X0\nM2\n", machine, name="p.ngc").plan
    motor_of = drive(machine, 0)
    assert plan is not None
    assert motor_of is not None
    points = operating_points(plan, 0, motor_of)
    assert points.speed.max() == pytest.approx(200 / 40 * math.tau, rel=1e-6)  # 40 mm a turn
    friction = motor_of.load.friction
    inertial = motor_of.inertia * 2000 / 40 * math.tau
    assert points.torque.max() == pytest.approx(inertial + friction, rel=1e-6)
    assert min(points.torque, key=lambda t: abs(t - (friction - inertial))) == pytest.approx(friction - inertial)
    # 0.1 s up, 0.4 s along, 0.1 s down, twice
    share = 0.2 / 0.6
    mean = share * (((inertial + friction) ** 2 + (inertial - friction) ** 2) / 2) + (1 - share) * friction**2
    assert points.rms == pytest.approx(math.sqrt(mean), rel=0.01)
    assert points.duty > 0.99
