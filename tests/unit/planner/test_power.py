"""Power of the beam over a trajectory, rests included."""

from __future__ import annotations

import numpy as np

from trochia.machine.load import load
from trochia.planner import plan
from trochia.program import MOVE, Dwell, MoveKind, Program
from trochia.toolpath import build


def lit(powers, *actions):
    """Return the trajectory of moves of 5 mm each, exact stops between, at the given powers."""
    moves = np.zeros(len(powers), MOVE)
    moves["target"][:, 0] = 5.0 * np.arange(1, len(powers) + 1)
    moves["kind"], moves["rate"], moves["power"], moves["path_mode"] = MoveKind.FEED, 10.0, powers, 3
    moves["line"] = np.arange(1, len(powers) + 1)
    machine = load("laser")
    program = Program(name="p", lines=9, start=np.zeros(9), moves=moves, actions=actions)
    return plan(build(program, machine), machine, program=program)


def test_power_is_that_of_the_move_under_way():
    trajectory = lit([0.0, 80.0, 30.0])
    x = np.linspace(0.01, 14.99, 700)
    t = np.interp(x, trajectory.position(grid := np.linspace(0, trajectory.duration, 20_000))[:, 0], grid)
    reached = trajectory.position(t)[:, 0]
    np.testing.assert_array_equal(trajectory.power_at(t), np.array([0.0, 80.0, 30.0])[(reached // 5).astype(int)])


def test_at_rest_power_is_that_of_the_next_move():
    trajectory = lit([20.0, 0.0, 50.0], *(Dwell(at=at, line=at, seconds=1.0) for at in range(4)))
    t = np.linspace(0, trajectory.duration, 5000)
    resting = trajectory.path_speed(t) == 0
    power = trajectory.power_at(t)
    place = np.rint(trajectory.position(t)[:, 0] / 5).astype(int)
    inside = resting & (np.roll(resting, 3) & np.roll(resting, -3))
    inside[[0, -1]] = True
    assert inside.sum() > 1000
    np.testing.assert_array_equal(power[inside], np.array([20.0, 0.0, 50.0, 0.0])[place[inside]])


def test_without_motion_there_is_no_power():
    program = Program(name="p", lines=1, start=np.zeros(9), moves=np.zeros(0, MOVE), actions=())
    machine = load("laser")
    trajectory = plan(build(program, machine), machine, program=program)
    np.testing.assert_array_equal(trajectory.power_at(np.zeros(3)), 0)
