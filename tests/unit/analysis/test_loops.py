"""Unstable gains are told by check, before anything runs; the poles are those of the loop's own response."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from trochia import api
from trochia.analysis.check import judge
from trochia.analysis.loops import UNSTABLE
from trochia.machine.friction import Friction
from trochia.machine.servo_plant import ServoPlant
from trochia.servo import Loop, Pid, low_pass, notch
from trochia.servo.sampled import closed_poles, held, pid_response, response, state_space

PERIOD = 5e-4
TWO = ServoPlant(
    torque_constant=0.1, motor_inertia=1e-4, load_inertia=2e-4, stiffness=20.0, damping=4e-3,
    motor_friction=Friction(viscous=2e-4), load_friction=Friction(viscous=3e-4),
)  # fmt: skip
JOB = b"G21 G90 G94\nF600\nG1 X5 Y5\nM2\n"


def problems(**gains: int) -> dict[str, str]:
    machine = api.load("xy-table")
    joint = machine.joints[1]
    assert joint.loop is not None
    machine = replace(machine, joints=(machine.joints[0], replace(joint, loop=replace(joint.loop, **gains))))
    verdict = judge(api.plan(api.gcode(JOB, machine), machine))
    assert verdict.ok is (UNSTABLE not in {p.code for p in verdict.problems})
    return {p.code: f"{p}" for p in verdict.problems}


def test_unstable_gains_are_told_with_joint_frequency_and_what_to_change() -> None:
    said = problems(i30=8000000, i31=5)[UNSTABLE]
    assert "the gains of joint Y are unstable" in said
    assert "Hz" in said
    assert "trochia tune --joint Y" in said
    assert UNSTABLE not in problems()


LOOPS = [
    Loop(period=PERIOD, position=Pid(kp=2.0, kd=0.02)),
    Loop(period=PERIOD, position=Pid(kp=20.0), speed=Pid(kp=0.05, ki=0.3)),
    Loop(period=PERIOD, position=Pid(kp=10.0, ki=3.0, kd=0.01, filter=300.0), speed=Pid(kp=0.05, ki=0.5), averaged=4,
         filters=(notch(70.0, PERIOD, depth=0.1), low_pass(300.0, PERIOD))),
]  # fmt: skip


@pytest.mark.parametrize("loop", LOOPS, ids=["pid", "cascade", "filtered"])
def test_at_every_pole_the_loop_is_minus_one(loop: Loop) -> None:
    """Against the responses, which are made of the same numbers in another way."""
    poles = closed_poles(TWO, loop)
    z = poles[np.abs(poles) > 0.3]  # nearer to 0, powers of 1/z lose their digits
    total = np.zeros(len(z), np.complex128)
    assert loop.position is not None
    total = pid_response(loop.position, z, PERIOD)
    if loop.speed is not None:
        total = pid_response(loop.speed, z, PERIOD) * (total + (1 - z**-loop.averaged) / (PERIOD * loop.averaged))
    for f in loop.filters:
        total = total * (f.b0 + f.b1 / z + f.b2 / z**2) / (1 + f.a1 / z + f.a2 / z**2)
    np.testing.assert_allclose(total * response(held(state_space(TWO), PERIOD), z), -1.0, atol=1e-3)
    assert len(z) >= 4
