"""The step library on the twin: what it asks for, the motor does, or loses steps where it cannot."""

from __future__ import annotations

import math
import time
from itertools import pairwise

import pytest

from trochia.backends.stepper_twin import StepperTwin
from trochia.errors import LimitError
from trochia.machine.drivers import HBridge, fed
from trochia.machine.motors import ShaftLoad, motor
from trochia.stepper import PacedTime, Shield, Stepper, TwinOutput, VirtualTime

SHIELD = motor("SM-42BYG011-25").parameters()


def rig(speed: float, acceleration: float) -> tuple[Stepper, TwinOutput]:
    load = ShaftLoad(inertia=2e-6, friction=0.004)
    output = TwinOutput(StepperTwin(fed(SHIELD, HBridge(supply=12.0)), load))
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
    assert turned == pytest.approx(100 * 1.8 + output.twin.made.excitation.first_angle / 50 * 180 / math.pi, abs=0.5)


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


def test_who_waited_is_not_hurried_afterwards(monkeypatch: pytest.MonkeyPatch):
    """A minute at a prompt is no time of the motor's: its five seconds afterwards last five."""
    wall, heard = [100.0], list[float]()
    monkeypatch.setattr(time, "monotonic", lambda: wall[0])
    monkeypatch.setattr(time, "sleep", lambda seconds: wall.__setitem__(0, wall[0] + seconds))
    paced = PacedTime()
    paced.follow(heard.append)
    paced.wait(1.0)
    wall[0] += 60.0
    paced.wait(5.0)
    assert paced.now == 6.0
    assert wall[0] == pytest.approx(166.0, abs=0.11)
    assert max(after - before for before, after in pairwise(heard)) < 0.13


@pytest.mark.parametrize("pace", [-1.0, math.nan, math.inf])
def test_a_pace_that_cannot_be_is_refused(pace: float):
    with pytest.raises(LimitError, match="pace"):
        PacedTime(pace)


def test_windings_that_are_let_go_hold_no_longer_and_align_when_they_are_on_again():
    """A weight turns a released rotor by whole teeth; switched on again it stands on a stable point, steps lost."""
    made = fed(SHIELD, HBridge(supply=12.0, excitation="two-phase", released="open"))
    twin = StepperTwin(made, ShaftLoad(inertia=2e-5, constant=0.02, viscous=1e-3))
    output = TwinOutput(twin)
    stepper = Stepper(output, VirtualTime())
    output.settle(0.5)
    held = float(output.settle(0.6).theta[-1])
    assert abs(held) < 0.05
    output.energise(0.6, on=False)
    fallen = float(output.settle(1.6).theta[-1])
    assert fallen < held - 1.0
    output.energise(1.6, on=True)
    run = output.settle(2.6)
    assert abs(run.omega[-1]) < 0.05
    assert run.lost_steps[-1] != 0
    assert int(run.lost_steps[-1]) % 4 == 0
    assert stepper.current_position() == 0


def test_a_shield_lets_go_and_takes_hold_again_with_the_next_step():
    """Released, its windings are shorted and their current dies away; a step puts it on again."""
    output = TwinOutput(
        StepperTwin(fed(SHIELD, HBridge(supply=12.0, excitation="one-phase")), ShaftLoad(friction=0.005))
    )
    clock = VirtualTime()
    board = Shield(clock).motor(1, 200, output)
    board.set_speed(60)
    board.step(20)
    on = abs(output.settle(clock.now).currents[-1]).max()
    board.release()
    clock.wait(0.5)
    off = abs(output.settle(clock.now).currents[-1]).max()
    board.step(20)
    again = output.settle(clock.now + 0.5)
    assert on > 0.2
    assert off < 1e-3
    assert abs(again.currents[-1]).max() > 0.2
    assert again.lost_steps[-1] == 0
    assert math.degrees(float(again.theta[-1])) == pytest.approx(40 * 1.8, abs=1)
