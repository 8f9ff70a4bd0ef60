"""The step library on the twin: what it asks for, the motor does, or loses steps where it cannot."""

from __future__ import annotations

import math
import time

import pytest

from trochia.backends.stepper_twin import StepperTwin
from trochia.machine.motors import ShaftLoad, motor
from trochia.pulses.excitation import excitation
from trochia.stepper import PacedTime, Stepper, TwinOutput, VirtualTime

SHIELD = motor("SM-42BYG011-25").parameters()


def rig(speed: float, acceleration: float) -> tuple[Stepper, TwinOutput]:
    load = ShaftLoad(inertia=2e-6, friction=0.004)
    output = TwinOutput(StepperTwin(SHIELD, excitation("two-phase"), 9.4, load))
    stepper = Stepper(output, VirtualTime())
    stepper.set_max_speed(speed)
    stepper.set_acceleration(acceleration)
    return stepper, output


def test_a_ramp_turns_the_shaft_and_loses_nothing():
    stepper, output = rig(500, 2000)
    stepper.run_to_new_position(300)
    stepper.run_to_new_position(100)
    assert output.lost_steps(stepper.time.now) == 0
    turned = math.degrees(float(output.twin.run(0.01).theta[-1]))
    assert turned == pytest.approx(100 * 1.8 + output.twin.excitation.first_angle / 50 * 180 / math.pi, abs=0.5)


def test_a_start_beyond_the_motor_loses_steps():
    stepper, output = rig(1500, 1e6)
    stepper.run_to_new_position(600)
    lost = output.lost_steps(stepper.time.now)
    assert lost != 0
    assert lost % 4 == 0


def test_paced_time_does_not_run_ahead(monkeypatch: pytest.MonkeyPatch):
    wall = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: wall[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: wall.__setitem__(0, wall[0] + seconds))
    paced = PacedTime(pace=2.0)
    paced.wait(1.0)
    assert wall[0] == pytest.approx(100.5)
    paced.wait_until(0.5)  # past already
    assert (paced.now, wall[0]) == (1.0, pytest.approx(100.5))
