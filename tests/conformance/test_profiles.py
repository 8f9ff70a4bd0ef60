"""Every velocity profile: the whole path, from rest to rest, without a gap, inside the limits."""

from __future__ import annotations

import numpy as np
import pytest

from trochia.languages import gcode
from trochia.machine.load import load
from trochia.planner import PROFILES, plan
from trochia.toolpath import build

TEXT = "G64 P0.02\nF4800\nG1 X30\nG3 X40 Y10 J10\nG1 Y30\nX0 Y31\nG4 P0.5\nG0 X0 Y0\nM2\n"


@pytest.fixture(params=sorted(PROFILES))
def trajectory(request):
    machine, program = load("reference-mill"), gcode.read(TEXT)
    path = build(program, machine, continuity=PROFILES[request.param].continuity)
    return plan(path, machine, program=program, profile=request.param)


def test_from_rest_to_rest_at_the_programs_ends(trajectory):
    ends = np.array([0.0, trajectory.duration])
    assert trajectory.position(ends) == pytest.approx(np.zeros((2, 3)), abs=1e-9)
    assert trajectory.velocity(ends) == pytest.approx(np.zeros((2, 3)), abs=1e-6)


def test_phases_fill_the_whole_time(trajectory):
    phases = np.concatenate(list(trajectory.blocks(size=8)))
    assert phases["t"][0] == 0.0
    assert phases["t"][1:] == pytest.approx(phases["t"][:-1] + phases["duration"][:-1], abs=1e-12)
    assert phases["t"][-1] + phases["duration"][-1] == pytest.approx(trajectory.duration)
    assert (np.diff(phases["segment"].astype(int)) >= 0).all()


def test_itemised_times_sum_to_the_whole(trajectory):
    assert sum(trajectory.times.values()) == pytest.approx(trajectory.duration)
    assert trajectory.times["dwell"] == 0.5
    assert trajectory.move_times.sum() == pytest.approx(trajectory.times["motion"])


def test_peaks_are_those_of_the_samples_and_inside_the_limits(trajectory):
    t = np.linspace(0, trajectory.duration, 20_001)
    kinds = ("velocity", "acceleration", "jerk") if trajectory.schedule.jerk_limited else ("velocity", "acceleration")
    for kind in kinds:
        seen = np.abs(getattr(trajectory, kind)(t)).max(axis=0)
        limits = getattr(trajectory.limits, kind)
        for column, letter in enumerate(trajectory.path.axes):
            peak = trajectory.peaks[letter][kind]
            assert peak <= limits[column] * (1 + 1e-9)
            assert seen[column] <= peak * (1 + 1e-3)


def test_the_rest_is_at_its_place(trajectory):
    phases = np.concatenate(list(trajectory.blocks()))
    (rest,) = phases[phases["flags"] & 1 == 1]
    assert rest["duration"] == pytest.approx(0.5)
    assert trajectory.position([rest["t"] + 0.1])[0] == pytest.approx([0, 31, 0])
