"""Machines whose steppers are physics: what they do at the end of a planned motion."""

from __future__ import annotations

import numpy as np
import pytest

from trochia import api, recorder
from trochia.analysis.errors import lost_steps
from trochia.backends.twin import Twin
from trochia.machine.load import loads

STAGE = """
format = 1
name = "stage"
kinematics = "cartesian"
[axes.X]
minimum = "-200 mm"
maximum = "200 mm"
velocity = "200 mm/s"
acceleration = "2000 mm/s²"
[axes.Y]
minimum = "-200 mm"
maximum = "200 mm"
velocity = "200 mm/s"
acceleration = "2000 mm/s²"
[joints.X]
motor = { kind = "stepper", library = "QSH5718-55", microsteps = 16 }
driver = { kind = "chopper", supply = "24 V", current = "2.8 A" }
load = { mass = "2 kg", friction = "10 N" }
transmission = { kind = "belt", pitch = "2 mm", teeth = 20 }
[joints.Y]
motor = { kind = "stepper", microsteps = 16 }
transmission = { kind = "belt", pitch = "2 mm", teeth = 20 }
"""
PROGRAM = b"G21 G90 G94\nG0 X30 Y10\nG1 X-20 Y0 F6000\nG2 X0 Y20 I20 J0\nG0 X0 Y0\nM2\n"


def simulated(text: str, **options: object) -> tuple[api.Machine, recorder.Recording, object]:
    machine = loads(text)
    verdict = api.check(PROGRAM, machine, name="p.ngc")
    assert verdict.plan is not None
    twin = Twin(machine=machine, **options)
    motion = verdict.plan.trajectory
    return machine, recorder.gather(twin.header(motion), twin.run(motion)), verdict


def test_a_strong_motor_follows_within_its_load_angle():
    machine, recording, verdict = simulated(STAGE)
    assert lost_steps(recording, machine) == {"X": 0, "Y": 0}
    assert verdict.torque["X"].used < 0.5
    angle = np.abs(recording["joint.X.load_angle"]).max()
    assert 5 < angle < 75
    # 90 electrical degrees are a full step: the travel behind the command follows from the load angle
    full_step = 40.0 / 200
    behind = np.abs(recording["X.actual"] - recording["X.commanded"]).max()
    assert behind == pytest.approx(angle / 90 * full_step, abs=full_step / 16 * 1.5)
    assert "joint.Y.load_angle" not in recording


def test_without_physics_it_is_the_ideal_twin():
    _, recording, _ = simulated(STAGE, physical=False)
    assert "joint.X.load_angle" not in recording
    assert np.abs(recording["X.actual"] - recording["X.commanded"]).max() < 40 / 3200


def test_an_overloaded_motor_is_named_by_the_check_and_loses_steps_on_the_twin():
    machine, recording, verdict = simulated(STAGE.replace("2.8 A", "0.5 A").replace("2 kg", "6 kg"))
    assert not verdict.ok
    assert verdict.movable
    problem = verdict.problems[0]
    assert (problem.code, problem.line) == ("steps-lost", 2)
    assert "joint X would lose steps" in problem.message
    assert verdict.figures()["margins"]["X"]["torque"] < 0
    lost = lost_steps(recording, machine)
    assert lost["X"] != 0
    assert lost["X"] % 4 == 0
    assert lost["Y"] == 0
    # what is lost stays: the carriage stands that many full steps off
    assert recording["X.actual"][-1] == pytest.approx(-lost["X"] * 40 / 200, abs=40 / 200)


def test_sampling_does_not_change_the_motion():
    _, fine, _ = simulated(STAGE, period=1e-3)
    _, coarse, _ = simulated(STAGE, period=4e-3)
    n = min(len(coarse), len(fine) // 4)
    apart = fine["joint.X.motor"][: 4 * n : 4] - coarse["joint.X.motor"][:n]
    assert np.abs(apart).max() < 2e-3


def test_a_mirrored_joint_moves_its_axis_the_same_way():
    _, plain, _ = simulated(STAGE)
    _, mirrored, _ = simulated(STAGE.replace("teeth = 20 }\n[joints.Y]", "teeth = 20, ratio = -1 }\n[joints.Y]"))
    assert mirrored["joint.X.motor"] == pytest.approx(plain["joint.X.motor"], abs=0.03)
