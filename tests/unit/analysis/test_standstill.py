"""Motors at rest: current that is reduced or switched off, and currents that slow decay cannot hold."""

from __future__ import annotations

import numpy as np
import pytest

from trochia import api, recorder
from trochia.analysis.errors import lost_steps
from trochia.analysis.standstill import stays
from trochia.backends.twin import Twin
from trochia.machine.load import loads

LIFT = """
format = 1
name = "lift"
kinematics = "cartesian"
[axes.Z]
minimum = "-200 mm"
maximum = "200 mm"
velocity = "50 mm/s"
acceleration = "300 mm/s²"
[joints.Z]
motor = { kind = "stepper", library = "QSH5718-55", microsteps = 16 }
driver = { kind = "chopper", supply = "24 V", current = "2.8 A", hold_delay = "0.1 s", MORE }
load = { mass = "5 kg", friction = "3 N", force = "49 N" }
transmission = { kind = "belt", pitch = "2 mm", teeth = 20 }
"""
DWELL = b"G21 G90 G94\nG0 Z10\nG4 P0.3\nG0 Z5\nM2\n"


def lift(more: str) -> tuple[api.Verdict, recorder.Recording, int]:
    """Return what the check says of a lift that dwells, and what its twin does."""
    machine = loads(LIFT.replace("MORE", more))
    verdict = api.check(DWELL, machine, name="p.ngc")
    assert verdict.plan is not None
    assert verdict.movable
    twin, motion = Twin(machine=machine, period=1e-3), verdict.plan.trajectory
    recording = recorder.gather(twin.header(motion), twin.run(motion))
    return verdict, recording, lost_steps(recording, machine)["Z"]


def test_current_is_reduced_in_a_dwell_and_comes_back_with_the_next_step():
    verdict, recording, lost = lift("hold_current = 0.7")
    current, height = recording["joint.Z.current"], recording["Z.commanded"]
    dwell = np.flatnonzero(height == 10)
    assert not [problem for problem in verdict.problems if problem.code == "hold-too-weak"]
    assert lost == 0
    assert current[dwell[0] + 50] == pytest.approx(2.75, abs=0.06)  # ms after the last step
    assert current[dwell[-1] - 5] == pytest.approx(0.7 * 2.75, abs=0.06)
    assert current[-1] == pytest.approx(2.75, abs=0.06)


@pytest.mark.parametrize(
    ("hold", "holds", "words"),
    [
        (0.56, True, ""),
        (0.5, False, "swings out of its place"),
        (0.3, False, "with 30% of its current"),
        (0.0, False, "with its current switched off"),
    ],
)
def test_a_weight_drops_where_the_check_says_so(hold: float, holds: bool, words: str):  # noqa: FBT001 - a parameter of the table
    verdict, recording, lost = lift(f"hold_current = {hold}")
    said = [problem for problem in verdict.problems if problem.code == "hold-too-weak"]
    assert (lost == 0) == holds == (not said)
    assert lost % 4 == 0
    if holds:
        assert recording["Z.actual"][-1] == pytest.approx(5, abs=0.1)
    else:
        assert recording["Z.actual"][-1] < -50
        assert words in said[0].message
        assert said[0].hint == "hold_current = 0.55 or more would hold it."
        assert not verdict.ok


def test_a_pendulum_without_load_stands_a_jump_to_72_percent():
    """The classical figure of equal areas: a torque that comes at once is held up to 0.7246 of the greatest."""
    assert stays(0.724, 1e9, 1.0)
    assert not stays(0.725, 1e9, 1.0)
    assert stays(0.999, 1.0, 1.0)  # nothing jumps
    assert not stays(1.001, 1.0, 1.0)


@pytest.mark.parametrize(
    ("more", "told"), [('decay = "slow"', True), ('decay = "mixed"', False), ('released = "open"', False)]
)
def test_currents_that_slow_decay_does_not_hold_are_told(more: str, told: bool):  # noqa: FBT001 - a parameter of the table
    verdict = api.check(DWELL, loads(LIFT.replace("MORE", more)), name="p.ngc")
    said = [problem for problem in verdict.problems if problem.code == "current-floor"]
    assert bool(said) == told
    assert verdict.ok
    if told:  # 24 V 1 us/(21 us 1.3 ohm) of 2.8 A: levels up to sin 18 degrees, of 16 to a quarter turn
        assert "keeps 0.879 A" in said[0].message
        assert "3 of the 16 levels" in said[0].message
